#include "base/file_lock.h"

#include <cerrno>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace surfcast {
namespace {

int open_file(const std::filesystem::path& path) {
  return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
}

bool lock(int descriptor, int operation) {
  int result = -1;
  do {
    result = ::flock(descriptor, operation);
  } while (result != 0 && errno == EINTR);
  return result == 0;
}

/// Whether the file is still the one of that name: it may have been removed or replaced before it was locked.
bool is_at(int descriptor, const std::filesystem::path& path) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(descriptor, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
         opened.st_ino == named.st_ino;
}

}  // namespace

std::optional<FileLock> FileLock::share(const std::filesystem::path& path) {
  while (true) {
    const int descriptor = open_file(path);
    if (descriptor < 0) return std::nullopt;
    FileLock taken(descriptor);
    if (!lock(descriptor, LOCK_SH)) return std::nullopt;
    if (is_at(descriptor, path)) return taken;
  }
}

std::optional<FileLock> FileLock::try_alone(const std::filesystem::path& path) {
  const int descriptor = open_file(path);
  if (descriptor < 0) return std::nullopt;
  FileLock taken(descriptor);
  if (!lock(descriptor, LOCK_EX | LOCK_NB) || !is_at(descriptor, path)) return std::nullopt;
  return taken;
}

FileLock::~FileLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace surfcast
