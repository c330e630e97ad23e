#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>

#include "base/result.h"

namespace surfcast {

/// A file that is read at positions. Unlike a mapped file, one that is overwritten, cut off or on a failing disk gives
/// errors, and what was read does not change any more. Safe to use from several threads at once.
class PositionedFile {
 public:
  static Result<PositionedFile> open(const std::filesystem::path& path);
  /// Takes a descriptor that is open for reading, and closes it also on failure. `name` is for errors.
  static Result<PositionedFile> adopt(int descriptor, const std::filesystem::path& name);

  PositionedFile(PositionedFile&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}
  PositionedFile& operator=(PositionedFile&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(size_, other.size_);
    return *this;
  }
  PositionedFile(const PositionedFile&) = delete;
  PositionedFile& operator=(const PositionedFile&) = delete;
  ~PositionedFile();

  /// Valid for as long as this object.
  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// Bytes of the file when it was opened.
  [[nodiscard]] uint64_t size() const { return size_; }
  /// Device, number, size and time of modification.
  [[nodiscard]] std::string version() const;
  /// Fills `bytes` with what is at `offset`. kIo when the disk fails, kInvalidInput when the file ends before.
  [[nodiscard]] Status read(uint64_t offset, std::span<std::byte> bytes) const;
  /// Tells the kernel to begin reading a part of the file. Returns at once.
  void prefetch(uint64_t offset, uint64_t size) const;

 private:
  PositionedFile(int descriptor, uint64_t size) : descriptor_(descriptor), size_(size) {}

  int descriptor_ = -1;
  uint64_t size_ = 0;
};

}  // namespace surfcast
