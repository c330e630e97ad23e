#include "base/repeat.h"

#include <condition_variable>
#include <mutex>

namespace surfcast {

void repeat(const std::stop_token& stop, std::chrono::milliseconds interval, const std::function<void()>& work) {
  std::mutex mutex;
  std::condition_variable_any wake;  // by the stop token alone
  std::unique_lock lock(mutex);
  for (;;) {
    wake.wait_for(lock, stop, interval, [] { return false; });
    if (stop.stop_requested()) return;
    work();
  }
}

}  // namespace surfcast
