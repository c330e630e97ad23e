#include "base/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/contract.h"
#include "base/file_lock.h"

namespace surfcast {
namespace {

tl::unexpected<Error> io_error(const std::filesystem::path& path, const char* what, int code) {
  return fail(ErrorKind::kIo, path.string() + ": " + what + ": " + std::strerror(code));
}

Status write_all(int descriptor, std::span<const std::byte> bytes, const std::filesystem::path& target, off_t offset) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor, bytes.data(), bytes.size(), offset);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return io_error(target, "cannot write", errno);
    bytes = bytes.subspan(static_cast<size_t>(written));
    offset += written;
  }
  return {};
}

/// Makes the rename durable: flushes the directory entry too.
void flush_directory_of(const std::filesystem::path& target) {
  const std::filesystem::path parent = target.parent_path().empty() ? "." : target.parent_path();
  const int descriptor = ::open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

/// Moves a file where there is none. Network file systems lack that form of rename, others lack links.
int rename_new(const char* from, const char* to) {
  const int moved = ::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE);
  if (moved == 0 || (errno != EINVAL && errno != ENOSYS)) return moved;
  return ::link(from, to) == 0 ? ::unlink(from) : -1;
}

constexpr std::string_view kMark = ".tmp";  // TARGET.tmpPID-NUMBER

/// Whether a name is that of a temporary file.
bool is_temporary(std::string_view name) {
  const size_t mark = name.rfind(kMark);
  if (mark == std::string_view::npos) return false;
  const std::string_view rest = name.substr(mark + kMark.size());
  const size_t dash = rest.find('-');
  const auto is_number = [](std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
  };
  return dash != std::string_view::npos && is_number(rest.substr(0, dash)) && is_number(rest.substr(dash + 1));
}

}  // namespace

Result<AtomicFile> AtomicFile::create(const std::filesystem::path& target) {
  static std::atomic<int> number{0};
  for (;;) {
    std::string temporary =
        target.string() + std::string(kMark) + std::to_string(::getpid()) + "-" + std::to_string(++number);
    // Registered before the file exists: a signal between the two steps would otherwise leave the file behind.
    UnfinishedFile unfinished(temporary);
    const int descriptor = ::open(temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno != EEXIST) return io_error(target, "cannot create", errno);
    if (descriptor < 0) continue;
    AtomicFile file(target, std::move(temporary), std::move(unfinished), descriptor);
    if (file.hold()) return file;
  }
}

AtomicFile::AtomicFile(std::filesystem::path target, std::filesystem::path temporary, UnfinishedFile unfinished,
                       int descriptor)
    : target_(std::move(target)),
      temporary_(std::move(temporary)),
      unfinished_(std::move(unfinished)),
      descriptor_(descriptor) {}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : target_(std::move(other.target_)),
      temporary_(std::move(other.temporary_)),
      unfinished_(std::move(other.unfinished_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      position_(other.position_) {}

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
  if (this == &other) return *this;
  discard();
  target_ = std::move(other.target_);
  temporary_ = std::move(other.temporary_);
  unfinished_ = std::move(other.unfinished_);
  descriptor_ = std::exchange(other.descriptor_, -1);
  position_ = other.position_;
  return *this;
}

AtomicFile::~AtomicFile() {
  discard();
}

/// Locks the file against remove_abandoned_files. False if that was faster. The lock is shared, so that readers of the
/// file in its final place need not wait for the end of `commit`. File systems without locks have no abandoned files.
bool AtomicFile::hold() const {
  struct stat status {};
  while (::flock(descriptor_, LOCK_SH) != 0 && errno == EINTR) continue;
  return ::fstat(descriptor_, &status) == 0 && status.st_nlink > 0;
}

void AtomicFile::discard() noexcept {
  if (descriptor_ < 0) return;
  ::close(std::exchange(descriptor_, -1));
  ::unlink(temporary_.c_str());
}

Status AtomicFile::append(std::span<const std::byte> bytes) {
  SURFCAST_EXPECTS(descriptor_ >= 0);
  if (Status status = write_all(descriptor_, bytes, target_, static_cast<off_t>(position_)); !status) return status;
  position_ += bytes.size();
  return {};
}

Status AtomicFile::overwrite(size_t offset, std::span<const std::byte> bytes) {
  SURFCAST_EXPECTS(descriptor_ >= 0 && offset + bytes.size() <= position_);
  return write_all(descriptor_, bytes, target_, static_cast<off_t>(offset));
}

Status AtomicFile::commit() {
  return commit(std::rename);
}

Status AtomicFile::commit_new() {
  return commit(rename_new);
}

Status AtomicFile::commit_unflushed() {
  SURFCAST_EXPECTS(descriptor_ >= 0);
  return put_in_place(std::rename);
}

Status AtomicFile::commit(int (*move)(const char* from, const char* to)) {
  SURFCAST_EXPECTS(descriptor_ >= 0);
  if (::fsync(descriptor_) != 0) return io_error(target_, "cannot flush", errno);
  if (Status status = put_in_place(move); !status) return status;
  flush_directory_of(target_);
  return {};
}

Status AtomicFile::put_in_place(int (*move)(const char* from, const char* to)) {
  if (move(temporary_.c_str(), target_.c_str()) != 0) return io_error(target_, "cannot rename into place", errno);
  ::close(std::exchange(descriptor_, -1));
  return {};
}

void remove_abandoned_files(const std::filesystem::path& folder) {
  std::error_code code;
  for (std::filesystem::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code)) {
    if (!is_temporary(entry->path().filename().string())) continue;
    std::error_code ignored;
    if (const auto alone = FileLock::try_alone(entry->path())) std::filesystem::remove(entry->path(), ignored);
  }
}

Status write_file_atomically(const std::filesystem::path& target, std::span<const std::byte> bytes) {
  Result<AtomicFile> file = AtomicFile::create(target);
  if (!file) return fail(file);
  if (Status status = file->append(bytes); !status) return status;
  return file->commit();
}

Status write_file_atomically(const std::filesystem::path& target, std::string_view text) {
  return write_file_atomically(target, std::as_bytes(std::span(text.data(), text.size())));
}

}  // namespace surfcast
