#include "stream/zstd_stream.h"

#include <string>
#include <utility>

#include <zstd.h>

#include "base/contract.h"

namespace surfcast::stream {
namespace {

/// log2 of the window that a frame may ask for.
constexpr int kLargestWindow = 27;

/// A block of 128 KiB takes at least 4 bytes (RFC 8878, RLE_Block).
constexpr uint64_t kLargestZstdBlock = uint64_t{1} << 17;
constexpr uint64_t kSmallestZstdBlock = 4;

}  // namespace

ZstdStream::ZstdStream(StreamPtr source) : source_(std::move(source)), state_(ZSTD_createDCtx()) {
  SURFCAST_EXPECTS(state_ != nullptr);
  ZSTD_DCtx_setParameter(state_, ZSTD_d_windowLogMax, kLargestWindow);
}

ZstdStream::~ZstdStream() {
  ZSTD_freeDCtx(state_);
}

uint64_t ZstdStream::at_most() const {
  const uint64_t blocks = (source_->at_most() + (filled_ - used_)) / kSmallestZstdBlock;
  // A decoder at work may still hold a window of bytes.
  return saturating(blocks, kLargestZstdBlock, filled_ > 0 ? uint64_t{1} << kLargestWindow : 0);
}

Result<size_t> ZstdStream::read(std::span<std::byte> out) {
  ZSTD_outBuffer output{out.data(), out.size(), 0};
  while (output.pos < output.size) {
    if (used_ == filled_) {
      const Result<size_t> read = source_->read(input_);
      if (!read) return fail(read);
      used_ = 0;
      filled_ = *read;
      if (filled_ == 0 && !within_frame_) break;
    }
    ZSTD_inBuffer input{input_.data(), filled_, used_};
    const size_t before = output.pos;
    const size_t code = ZSTD_decompressStream(state_, &output, &input);
    if (ZSTD_isError(code)) {
      return fail(ErrorKind::kInvalidInput, std::string("damaged compressed data: ") + ZSTD_getErrorName(code));
    }
    used_ = input.pos;
    within_frame_ = code != 0;
    if (filled_ == 0 && output.pos == before && within_frame_) {
      return fail(ErrorKind::kInvalidInput, "truncated: the compressed data ends too early");
    }
  }
  return output.pos;
}

}  // namespace surfcast::stream
