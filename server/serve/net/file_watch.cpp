#include "net/file_watch.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <cerrno>
#include <chrono>
#include <set>
#include <system_error>
#include <utility>

#include <sys/inotify.h>
#include <unistd.h>

#include "net/redirect_error_to.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
namespace fs = std::filesystem;
using boost::system::error_code;

/// A certificate and its key are two files: the second follows within this time. Not a setting: a pair that does not
/// belong together is refused anyway, and the next change tried again.
constexpr std::chrono::milliseconds kSettle{200};

std::set<fs::path> folders_of(std::span<const fs::path> files) {
  std::set<fs::path> folders;
  for (const fs::path& file : files) folders.insert(fs::absolute(file).parent_path());
  return folders;
}

}  // namespace

FileWatch::FileWatch(const asio::any_io_executor& executor, int descriptor, std::function<void()> changed)
    : events_(executor, descriptor), pause_(executor), changed_(std::move(changed)) {}

Result<std::shared_ptr<FileWatch>> FileWatch::start(const asio::any_io_executor& executor,
                                                    std::span<const fs::path> files, std::function<void()> changed) {
  const int descriptor = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  if (descriptor < 0) return fail(ErrorKind::kIo, "files cannot be watched: " + std::generic_category().message(errno));
  auto watch = std::make_shared<FileWatch>(executor, descriptor, std::move(changed));
  for (const fs::path& folder : folders_of(files)) {
    constexpr uint32_t kEvents = IN_CLOSE_WRITE | IN_MOVED_TO | IN_CREATE | IN_DELETE | IN_ATTRIB;
    if (::inotify_add_watch(descriptor, folder.c_str(), kEvents) < 0) {
      return fail(ErrorKind::kIo, folder.string() + ": cannot be watched: " + std::generic_category().message(errno));
    }
  }
  asio::co_spawn(
      executor, [](std::shared_ptr<FileWatch> self) -> asio::awaitable<void> { co_await self->watch(); }(watch),
      asio::detached);
  return watch;
}

void FileWatch::stop() {
  error_code ignored;
  events_.close(ignored);
  pause_.cancel();
}

asio::awaitable<void> FileWatch::watch() {
  error_code code;
  while (events_.is_open()) {
    co_await events_.async_read_some(asio::buffer(buffer_), redirect_error_to(code));
    if (code) co_return;
    pause_.expires_after(kSettle);
    co_await pause_.async_wait(redirect_error_to(code));
    if (!events_.is_open()) co_return;
    changed_();
  }
}

}  // namespace surfcast::net
