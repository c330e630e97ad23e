#pragma once

#include <filesystem>
#include <optional>
#include <utility>

namespace surfcast {

/// A lock of an existing file, for as long as it lives. It keeps out other locks of the file, in this process and in
/// others, but nobody who asks for none.
class FileLock {
 public:
  /// A lock that others may share; waits for whoever has the file alone. None if the file cannot be opened.
  static std::optional<FileLock> share(const std::filesystem::path& path);
  /// The only lock of the file; none if it cannot be had at once.
  static std::optional<FileLock> try_alone(const std::filesystem::path& path);

  FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileLock& operator=(FileLock&&) = delete;
  ~FileLock();

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}

  int descriptor_;
};

}  // namespace surfcast
