#pragma once

#include <array>
#include <memory>

#include "stream/byte_stream.h"

struct ZSTD_DCtx_s;

namespace surfcast::stream {

/// Data compressed by zstd, any number of frames. A frame states the memory that it needs; more than 128 MiB is
/// refused.
class ZstdStream final : public ByteStream {
 public:
  explicit ZstdStream(StreamPtr source);
  ~ZstdStream() override;
  Result<size_t> read(std::span<std::byte> out) override;
  [[nodiscard]] uint64_t at_most() const override;

 private:
  StreamPtr source_;
  ZSTD_DCtx_s* state_;
  bool within_frame_ = true;
  size_t used_ = 0;
  size_t filled_ = 0;
  std::array<std::byte, size_t{1} << 14> input_;
};

}  // namespace surfcast::stream
