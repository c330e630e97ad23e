#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "base/result.h"

namespace surfcast {

/// A whole file mapped read-only. The bytes stay valid as long as the object lives.
class MappedFile {
 public:
  static Result<MappedFile> open(const std::filesystem::path& path);

  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  [[nodiscard]] std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(data_), size_}; }

  /// Prefetches a part of the file: tells the kernel to begin reading it. Returns at once.
  void prefetch(size_t offset, size_t size) const;

  /// Releases the resident pages of the file, which bounds the memory that reading a large file takes. Later accesses
  /// read the pages again. Safe from any thread, also while others read.
  void release_pages() const;

 private:
  MappedFile(void* data, size_t size) : data_(data), size_(size) {}

  void* data_ = nullptr;
  size_t size_ = 0;
};

}  // namespace surfcast
