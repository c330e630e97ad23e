#include "stream/inflate_stream.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "base/contract.h"

namespace surfcast::stream {
namespace {

/// Window of 32 KiB; gzip or zlib by the first bytes (zlib.h, inflateInit2).
constexpr int kWindowAndDetection = 15 + 32;

/// A symbol of deflate takes at least 2 bits for at most 258 bytes (zlib's technical notes).
constexpr uint64_t kLargestRatio = 1032;
/// Bytes that a decoder at work may still yield without further input.
constexpr uint64_t kPending = uint64_t{1} << 16;

tl::unexpected<Error> damaged(const char* why) {
  return fail(ErrorKind::kInvalidInput, std::string("damaged compressed data: ") + (why != nullptr ? why : "zlib"));
}

}  // namespace

InflateStream::InflateStream(StreamPtr source) : source_(std::move(source)) {
  SURFCAST_EXPECTS(inflateInit2(&state_, kWindowAndDetection) == Z_OK);
}

InflateStream::~InflateStream() {
  inflateEnd(&state_);
}

uint64_t InflateStream::at_most() const {
  if (ended_) return 0;
  return saturating(saturating(source_->at_most(), 1, state_.avail_in), kLargestRatio,
                    state_.total_in > 0 ? kPending : 0);
}

/// Moves the unread input to the front and appends to it. Fewer than two bytes are left only at the end of the input.
Status InflateStream::refill() {
  if (state_.avail_in > 0) std::memmove(input_.data(), state_.next_in, state_.avail_in);
  state_.next_in = reinterpret_cast<Bytef*>(input_.data());
  const Result<size_t> read = source_->read(std::span(input_).subspan(state_.avail_in));
  if (!read) return fail(read);
  state_.avail_in += static_cast<uInt>(*read);
  return {};
}

Status InflateStream::begin_next_member() {
  if (state_.avail_in < 2) {
    if (Status status = refill(); !status) return status;
  }
  const bool more = state_.avail_in >= 2 && state_.next_in[0] == 0x1f && state_.next_in[1] == 0x8b;
  if (more) {
    inflateReset(&state_);
  } else {
    ended_ = true;
  }
  return {};
}

Result<size_t> InflateStream::read(std::span<std::byte> out) {
  size_t done = 0;
  while (done < out.size() && !ended_) {
    if (state_.avail_in == 0) {
      if (Status status = refill(); !status) return fail(status);
      if (state_.avail_in == 0) return fail(ErrorKind::kInvalidInput, "truncated: the compressed data ends too early");
    }
    const size_t wanted = std::min<size_t>(out.size() - done, std::numeric_limits<uInt>::max());
    state_.next_out = reinterpret_cast<Bytef*>(out.data() + done);
    state_.avail_out = static_cast<uInt>(wanted);
    const int code = inflate(&state_, Z_NO_FLUSH);
    done += wanted - state_.avail_out;
    if (code == Z_STREAM_END) {
      if (Status status = begin_next_member(); !status) return fail(status);
    } else if (code != Z_OK && code != Z_BUF_ERROR) {
      return damaged(state_.msg);
    }
  }
  return done;
}

bool is_gzip(std::span<const std::byte> bytes) {
  return bytes.size() > 2 && bytes[0] == std::byte{0x1f} && bytes[1] == std::byte{0x8b};
}

StreamPtr open_inflated(const FilePtr& file) {
  StreamPtr stream = std::make_unique<MappedStream>(file);
  return is_gzip(file->bytes()) ? std::make_unique<InflateStream>(std::move(stream)) : std::move(stream);
}

}  // namespace surfcast::stream
