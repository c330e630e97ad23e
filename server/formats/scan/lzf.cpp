#include "scan/lzf.h"

#include <cstring>

namespace surfcast::scan {
namespace {

// A control byte c below 32 starts a run of c + 1 literal bytes. Any other control byte refers back to earlier output:
// its upper three bits are the length less 2 (if they are 7, the next byte is added), its lower five bits are the upper
// bits of the distance less 1. The lower eight bits of the distance follow.
constexpr unsigned kLiteral = 32;
constexpr unsigned kLongLength = 7;
constexpr size_t kMaxLzfExpansion = 132;  // an upper bound: 3 bytes expand to at most 264

class Decoder {
 public:
  Decoder(std::span<const std::byte> in, std::span<uint8_t> out) : in_(in), out_(out) {}

  /// True if all input was consumed and all output written.
  bool run() {
    while (read_ < in_.size()) {
      const unsigned control = take();
      if (!(control < kLiteral ? copy_literal(control + 1) : copy_back(control))) return false;
    }
    return written_ == out_.size();
  }

 private:
  unsigned take() { return std::to_integer<unsigned>(in_[read_++]); }

  bool copy_literal(size_t length) {
    if (length > in_.size() - read_ || length > out_.size() - written_) return false;
    std::memcpy(&out_[written_], &in_[read_], length);
    read_ += length;
    written_ += length;
    return true;
  }

  bool copy_back(unsigned control) {
    size_t length = control >> 5;
    if (length == kLongLength) {
      if (read_ == in_.size()) return false;
      length += take();
    }
    length += 2;
    if (read_ == in_.size()) return false;
    const size_t distance = ((control & 31U) << 8) + take() + 1;
    if (distance > written_ || length > out_.size() - written_) return false;
    // Byte by byte, because source and destination may overlap.
    for (size_t i = 0; i < length; ++i, ++written_) out_[written_] = out_[written_ - distance];
    return true;
  }

  std::span<const std::byte> in_;
  std::span<uint8_t> out_;
  size_t read_ = 0;
  size_t written_ = 0;
};

}  // namespace

std::optional<std::vector<uint8_t>> decompress_lzf(std::span<const std::byte> compressed, size_t size) {
  if (size / kMaxLzfExpansion > compressed.size()) return std::nullopt;
  std::vector<uint8_t> out(size);
  if (!Decoder(compressed, out).run()) return std::nullopt;
  return out;
}

}  // namespace surfcast::scan
