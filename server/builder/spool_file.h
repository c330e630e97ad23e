#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "base/result.h"

namespace surfcast::builder {

/// A temporary file without a name, in the folder of a target: it takes no room any more once it is closed, however the
/// program ends. Failures name the target.
class SpoolFile {
 public:
  static Result<SpoolFile> create(const std::filesystem::path& target);

  SpoolFile(SpoolFile&& other) noexcept;
  SpoolFile& operator=(SpoolFile&& other) noexcept;
  SpoolFile(const SpoolFile&) = delete;
  SpoolFile& operator=(const SpoolFile&) = delete;
  ~SpoolFile();

  /// Appends, and returns where. One thread at a time.
  Result<uint64_t> append(std::span<const std::byte> bytes);
  /// Fills `bytes` with what lies from `offset` on. Any thread.
  Status read(uint64_t offset, std::span<std::byte> bytes) const;
  /// Gives the room of some bytes back to the file system, where it can take holes. Any thread.
  void release(uint64_t offset, uint64_t size) const;
  [[nodiscard]] uint64_t size() const { return size_; }

 private:
  SpoolFile(std::filesystem::path target, int descriptor) : target_(std::move(target)), descriptor_(descriptor) {}

  std::filesystem::path target_;
  int descriptor_ = -1;
  uint64_t size_ = 0;
};

}  // namespace surfcast::builder
