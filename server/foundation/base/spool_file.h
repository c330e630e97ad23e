#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "base/result.h"

namespace surfcast {

/// A temporary file without a name, in the folder of the target. Its disk space is freed when it is closed, however the
/// program ends. Errors name the target.
class SpoolFile {
 public:
  static Result<SpoolFile> create(const std::filesystem::path& target);

  SpoolFile(SpoolFile&& other) noexcept;
  SpoolFile& operator=(SpoolFile&& other) noexcept;
  SpoolFile(const SpoolFile&) = delete;
  SpoolFile& operator=(const SpoolFile&) = delete;
  ~SpoolFile();

  /// Appends and returns the offset. Must be called by one thread at a time.
  Result<uint64_t> append(std::span<const std::byte> bytes);
  /// Fills `bytes` from `offset` on. Thread-safe.
  Status read(uint64_t offset, std::span<std::byte> bytes) const;
  /// Releases disk space, if the file system supports holes. Thread-safe.
  void release(uint64_t offset, uint64_t size) const;
  [[nodiscard]] uint64_t size() const { return size_; }

 private:
  SpoolFile(std::filesystem::path target, int descriptor) : target_(std::move(target)), descriptor_(descriptor) {}

  std::filesystem::path target_;
  int descriptor_ = -1;
  uint64_t size_ = 0;
};

}  // namespace surfcast
