#include "base/positioned_file.h"

#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace surfcast {

namespace {

tl::unexpected<Error> file_error(const std::filesystem::path& name, const char* what, int code) {
  return fail(code == ENOENT ? ErrorKind::kNotFound : ErrorKind::kIo,
              name.string() + ": " + what + ": " + std::strerror(code));
}

}  // namespace

Result<PositionedFile> PositionedFile::open(const std::filesystem::path& path) {
  // Without O_NONBLOCK a pipe of that name would block the caller.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return file_error(path, "cannot open", errno);
  return adopt(descriptor, path);
}

Result<PositionedFile> PositionedFile::adopt(int descriptor, const std::filesystem::path& name) {
  struct stat information {};
  if (::fstat(descriptor, &information) != 0 || !S_ISREG(information.st_mode)) {
    const int code = S_ISDIR(information.st_mode) ? EISDIR : EINVAL;
    ::close(descriptor);
    return file_error(name, "cannot read", code);
  }
  return PositionedFile(descriptor, static_cast<uint64_t>(information.st_size));
}

PositionedFile::~PositionedFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Status PositionedFile::read(uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t count = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return fail(ErrorKind::kIo, std::string("cannot read: ") + std::strerror(errno));
    if (count == 0) return fail(ErrorKind::kInvalidInput, "the file has been cut off");
    offset += static_cast<uint64_t>(count);
    bytes = bytes.subspan(static_cast<size_t>(count));
  }
  return {};
}

std::string PositionedFile::version() const {
  struct stat information {};
  if (::fstat(descriptor_, &information) != 0) return {};
  return std::to_string(information.st_dev) + '-' + std::to_string(information.st_ino) + '-' +
         std::to_string(information.st_size) + '-' + std::to_string(information.st_mtim.tv_sec) + '.' +
         std::to_string(information.st_mtim.tv_nsec);
}

void PositionedFile::prefetch(uint64_t offset, uint64_t size) const {
  ::posix_fadvise(descriptor_, static_cast<off_t>(offset), static_cast<off_t>(size), POSIX_FADV_WILLNEED);
}

}  // namespace surfcast
