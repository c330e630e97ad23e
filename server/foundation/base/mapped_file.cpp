#include "base/mapped_file.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/contract.h"

namespace surfcast {

Result<MappedFile> MappedFile::open(const std::filesystem::path& path) {
  const auto error = [&path](const char* what, int code) {
    return fail(code == ENOENT ? ErrorKind::kNotFound : ErrorKind::kIo,
                path.string() + ": " + what + ": " + std::strerror(code));
  };
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return error("cannot open", errno);
  struct stat information {};
  if (::fstat(descriptor, &information) != 0 || !S_ISREG(information.st_mode)) {
    const int code = S_ISDIR(information.st_mode) ? EISDIR : EINVAL;
    ::close(descriptor);
    return error("cannot read", code);
  }
  const auto size = static_cast<size_t>(information.st_size);
  void* data = nullptr;
  if (size > 0) {
    data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (data == MAP_FAILED) {
      const int code = errno;
      ::close(descriptor);
      return error("cannot map", code);
    }
  }
  ::close(descriptor);
  return MappedFile(data, size);
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(data_, size_);
}

void MappedFile::prefetch(size_t offset, size_t size) const {
  static const auto kPage = static_cast<size_t>(::sysconf(_SC_PAGESIZE));
  SURFCAST_EXPECTS(offset <= size_ && size <= size_ - offset);
  const size_t first = offset / kPage * kPage;
  if (size > 0) ::madvise(static_cast<std::byte*>(data_) + first, offset + size - first, MADV_WILLNEED);
}

void MappedFile::release_pages() const {
  if (data_ != nullptr) ::madvise(data_, size_, MADV_DONTNEED);
}

}  // namespace surfcast
