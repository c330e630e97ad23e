#include "stream/bzip2_stream.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/contract.h"

namespace surfcast::stream {
namespace {

/// A block of 900,000 bytes of runs of up to 255 (5 bytes each) takes at least some 40 bytes.
constexpr uint64_t kLargestBzip2Block = uint64_t{900000} / 5 * 255;
constexpr uint64_t kSmallestBzip2Block = 32;

}  // namespace

Bzip2Stream::Bzip2Stream(StreamPtr source) : source_(std::move(source)) {
  SURFCAST_EXPECTS(BZ2_bzDecompressInit(&state_, 0, 0) == BZ_OK);
}

Bzip2Stream::~Bzip2Stream() {
  BZ2_bzDecompressEnd(&state_);
}

uint64_t Bzip2Stream::at_most() const {
  if (ended_) return 0;
  return saturating((source_->at_most() + state_.avail_in) / kSmallestBzip2Block + 1, kLargestBzip2Block,
                    kLargestBzip2Block);
}

Status Bzip2Stream::refill() {
  state_.next_in = reinterpret_cast<char*>(input_.data());
  const Result<size_t> read = source_->read(input_);
  if (!read) return fail(read);
  state_.avail_in = static_cast<unsigned>(*read);
  return {};
}

Status Bzip2Stream::begin_next_part() {
  if (state_.avail_in == 0) {
    if (Status status = refill(); !status) return status;
  }
  ended_ = state_.avail_in == 0;
  if (ended_) return {};
  BZ2_bzDecompressEnd(&state_);
  SURFCAST_EXPECTS(BZ2_bzDecompressInit(&state_, 0, 0) == BZ_OK);  // leaves the input as it is
  return {};
}

Result<size_t> Bzip2Stream::read(std::span<std::byte> out) {
  size_t done = 0;
  while (done < out.size() && !ended_) {
    if (state_.avail_in == 0) {
      if (Status status = refill(); !status) return fail(status);
      if (state_.avail_in == 0) return fail(ErrorKind::kInvalidInput, "truncated: the compressed data ends too early");
    }
    const size_t wanted = std::min<size_t>(out.size() - done, std::numeric_limits<unsigned>::max());
    state_.next_out = reinterpret_cast<char*>(out.data() + done);
    state_.avail_out = static_cast<unsigned>(wanted);
    const int code = BZ2_bzDecompress(&state_);
    done += wanted - state_.avail_out;
    if (code == BZ_STREAM_END) {
      if (Status status = begin_next_part(); !status) return fail(status);
    } else if (code != BZ_OK) {
      return fail(ErrorKind::kInvalidInput, "damaged compressed data (bzip2)");
    }
  }
  return done;
}

}  // namespace surfcast::stream
