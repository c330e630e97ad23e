#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "stream/byte_stream.h"

namespace surfcast::testing {

/// Bytes of memory in portions of at most `portion`, so that decoders meet every end of their input.
class MemoryStream final : public stream::ByteStream {
 public:
  explicit MemoryStream(std::string bytes, size_t portion = SIZE_MAX) : bytes_(std::move(bytes)), portion_(portion) {}
  Result<size_t> read(std::span<std::byte> out) override {
    const size_t size = std::min({out.size(), portion_, bytes_.size() - at_});
    std::memcpy(out.data(), bytes_.data() + at_, size);
    at_ += size;
    return size;
  }
  [[nodiscard]] uint64_t at_most() const override { return bytes_.size() - at_; }

 private:
  std::string bytes_;
  size_t portion_;
  size_t at_ = 0;
};

inline stream::StreamPtr in_memory(std::string bytes, size_t portion = SIZE_MAX) {
  return std::make_unique<MemoryStream>(std::move(bytes), portion);
}

/// All bytes of a stream, read in portions.
inline Result<std::string> read_all(stream::ByteStream& stream, size_t portion = 1000) {
  std::string text;
  for (std::string part(portion, '\0');; part.resize(portion)) {
    const Result<size_t> read = stream.read(std::as_writable_bytes(std::span(part)));
    if (!read) return fail(read);
    text.append(part, 0, *read);
    if (*read < portion) return text;
  }
}

}  // namespace surfcast::testing
