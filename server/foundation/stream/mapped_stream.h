#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "base/mapped_file.h"
#include "stream/byte_stream.h"

namespace surfcast::stream {

using FilePtr = std::shared_ptr<const MappedFile>;

/// Opens a file that several streams share.
Result<FilePtr> open_shared(const std::filesystem::path& path);

/// A part of a file. Pages that were read are given back every few megabytes, so that a file larger than memory can be
/// read.
class MappedStream final : public ByteStream {
 public:
  /// From `offset` (at most the size of the file) to the end, or over `size` bytes if the file has them.
  explicit MappedStream(FilePtr file, uint64_t offset = 0, uint64_t size = UINT64_MAX);
  Result<size_t> read(std::span<std::byte> out) override;
  Status skip(uint64_t count) override;
  [[nodiscard]] uint64_t at_most() const override { return rest_.size(); }

 private:
  FilePtr file_;
  std::span<const std::byte> rest_;
  uint64_t unreleased_ = 0;
};

}  // namespace surfcast::stream
