#include "base/scratch_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

namespace surfcast {

namespace fs = std::filesystem;

Result<ScratchFolder> ScratchFolder::create(const fs::path& parent, const std::string& prefix) {
  for (;;) {
    std::string name = (parent / (prefix + "XXXXXX")).string();
    if (::mkdtemp(name.data()) == nullptr) {
      return fail(ErrorKind::kIo, parent.string() + ": cannot make a folder in it: " + std::strerror(errno));
    }
    std::optional<FileLock> lock = FileLock::share(name);
    std::error_code ignored;
    if (lock || fs::exists(name, ignored)) return ScratchFolder(std::move(name), std::move(lock));
    // Somebody took it for abandoned before it was locked.
  }
}

ScratchFolder::ScratchFolder(fs::path path, std::optional<FileLock> lock)
    : path_(std::move(path)), lock_(std::move(lock)) {}

ScratchFolder::ScratchFolder(ScratchFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})), lock_(std::move(other.lock_)) {}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

void remove_abandoned_folders(const fs::path& parent, const std::string& prefix) {
  std::error_code code;
  for (fs::directory_iterator entry(parent, code), end; !code && entry != end; entry.increment(code)) {
    std::error_code ignored;
    const bool named = entry->path().filename().string().starts_with(prefix);
    if (!named || !fs::is_directory(entry->symlink_status(ignored))) continue;
    if (const auto alone = FileLock::try_alone(entry->path())) fs::remove_all(entry->path(), ignored);
  }
}

}  // namespace surfcast
