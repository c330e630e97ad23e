#include "base/spool_file.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace surfcast {
namespace {

tl::unexpected<Error> spool_error(const std::filesystem::path& target, const char* what, int code) {
  return fail(ErrorKind::kIo, target.string() + ": " + what + ": " + std::strerror(code));
}

/// Creates a file without a name. On file systems without O_TMPFILE, creates a named file and unlinks it at once.
int open_unnamed(const std::filesystem::path& target) {
  const std::filesystem::path folder = target.parent_path().empty() ? "." : target.parent_path();
  const int unnamed = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (unnamed >= 0) return unnamed;
  std::string name = target.string() + ".spoolXXXXXX";
  const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor >= 0) ::unlink(name.c_str());
  return descriptor;
}

}  // namespace

Result<SpoolFile> SpoolFile::create(const std::filesystem::path& target) {
  const int descriptor = open_unnamed(target);
  if (descriptor < 0) return spool_error(target, "cannot create a temporary file beside it", errno);
  return SpoolFile(target, descriptor);
}

SpoolFile::SpoolFile(SpoolFile&& other) noexcept
    : target_(std::move(other.target_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

SpoolFile& SpoolFile::operator=(SpoolFile&& other) noexcept {
  std::swap(target_, other.target_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(size_, other.size_);
  return *this;
}

SpoolFile::~SpoolFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<uint64_t> SpoolFile::append(std::span<const std::byte> bytes) {
  const uint64_t offset = size_;
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(size_));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return spool_error(target_, "cannot write the temporary file beside it", errno);
    bytes = bytes.subspan(static_cast<size_t>(written));
    size_ += static_cast<uint64_t>(written);
  }
  return offset;
}

Status SpoolFile::read(uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t got = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return spool_error(target_, "cannot read the temporary file beside it", got < 0 ? errno : EIO);
    bytes = bytes.subspan(static_cast<size_t>(got));
    offset += static_cast<uint64_t>(got);
  }
  return {};
}

void SpoolFile::release(uint64_t offset, uint64_t size) const {
  ::fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(offset),
              static_cast<off_t>(size));
}

}  // namespace surfcast
