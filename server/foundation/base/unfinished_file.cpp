#include "base/unfinished_file.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <climits>
#include <csignal>
#include <string>

#include <unistd.h>

namespace surfcast {
namespace {

enum class SlotState { kFree, kBeingFilled, kFilled };

/// A path that a signal handler can read: static memory that is never freed.
struct Slot {
  std::atomic<SlotState> state{SlotState::kFree};
  std::array<char, PATH_MAX> path{};
};
static_assert(std::atomic<SlotState>::is_always_lock_free);

/// More than the number of files written at one time. A file without a slot is removed by its owner only.
std::array<Slot, 16> slots;

/// Calls only async-signal-safe functions.
void remove_files_and_end(int signal) {
  for (const Slot& slot : slots) {
    if (slot.state.load() == SlotState::kFilled) ::unlink(slot.path.data());
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace

UnfinishedFile::UnfinishedFile(const std::filesystem::path& path) {
  const std::string& name = path.native();
  if (name.size() >= PATH_MAX) return;  // such a file cannot be created either
  for (size_t i = 0; i < slots.size(); ++i) {
    SlotState free = SlotState::kFree;
    if (!slots[i].state.compare_exchange_strong(free, SlotState::kBeingFilled)) continue;
    *std::copy(name.begin(), name.end(), slots[i].path.begin()) = '\0';
    slots[i].state = SlotState::kFilled;
    slot_ = static_cast<int>(i);
    return;
  }
}

UnfinishedFile::~UnfinishedFile() {
  if (slot_ != kNone) slots[static_cast<size_t>(slot_)].state = SlotState::kFree;
}

void remove_unfinished_files_on_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (std::signal(signal, remove_files_and_end) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

}  // namespace surfcast
