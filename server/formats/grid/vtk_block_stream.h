#pragma once

#include <memory>
#include <vector>

#include "stream/byte_stream.h"

namespace surfcast::grid {

/// How the numbers of VTK's XML files are stored behind a header of integers.
struct VtkBlockCoding {
  bool compressed = false;  ///< blocks, each compressed by zlib
  bool wide = false;        ///< header integers of 64 bits, not 32
  bool swapped = false;     ///< in the byte order that is not this machine's
};

/// The bytes of an array. The header of plain bytes is their number. The header of compressed bytes is the number of
/// blocks, the size of a block, the size of the last block if that is smaller (else 0), and the compressed sizes.
class VtkBlockStream final : public stream::ByteStream {
 public:
  static Result<stream::StreamPtr> open(stream::StreamPtr source, const VtkBlockCoding& coding);
  ~VtkBlockStream() override;
  Result<size_t> read(std::span<std::byte> out) override;
  [[nodiscard]] uint64_t at_most() const override;

 private:
  explicit VtkBlockStream(stream::StreamPtr source) : source_(std::move(source)) {}
  Status read_header(const VtkBlockCoding& coding);
  Status begin_block();
  Status end_block();

  stream::StreamPtr source_;
  std::vector<uint64_t> packed_sizes_;
  uint64_t block_size_ = 0;
  uint64_t last_size_ = 0;
  size_t next_ = 0;
  uint64_t left_ = 0;  ///< of the current block, or of plain bytes
  uint64_t unpacked_ = 0;
  std::unique_ptr<stream::LimitedStream> packed_;
  stream::StreamPtr block_;
};

}  // namespace surfcast::grid
