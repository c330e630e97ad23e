#include "stream/byte_stream.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace surfcast::stream {
namespace {

constexpr size_t kScratch = size_t{1} << 16;

tl::unexpected<Error> ends_early() {
  return fail(ErrorKind::kInvalidInput, "truncated: the data ends too early");
}

}  // namespace

Status ByteStream::skip(uint64_t count) {
  std::vector<std::byte> scratch(std::min<uint64_t>(count, kScratch));
  while (count > 0) {
    const std::span part = std::span(scratch).first(std::min<uint64_t>(count, scratch.size()));
    if (Status status = read_exactly(*this, part); !status) return status;
    count -= part.size();
  }
  return {};
}

Status read_exactly(ByteStream& stream, std::span<std::byte> out) {
  const Result<size_t> read = stream.read(out);
  if (!read) return fail(read);
  if (*read < out.size()) return ends_early();
  return {};
}

Status check_end(ByteStream& stream) {
  std::byte next{};
  return stream.read({&next, 1}).map([](size_t) {});
}

uint64_t saturating(uint64_t a, uint64_t b, uint64_t c) {
  uint64_t product = 0;
  uint64_t sum = 0;
  if (__builtin_mul_overflow(a, b, &product) || __builtin_add_overflow(product, c, &sum)) {
    return std::numeric_limits<uint64_t>::max();
  }
  return sum;
}

Result<size_t> LimitedStream::read(std::span<std::byte> out) {
  Result<size_t> read = source_.read(out.first(std::min<uint64_t>(out.size(), left_)));
  if (read) left_ -= *read;
  return read;
}

uint64_t LimitedStream::at_most() const {
  return std::min(left_, source_.at_most());
}

}  // namespace surfcast::stream
