#pragma once

#include <array>

#include <bzlib.h>

#include "stream/byte_stream.h"

namespace surfcast::stream {

/// Data compressed by bzip2, any number of streams one after another. Takes at most 4 MB.
class Bzip2Stream final : public ByteStream {
 public:
  explicit Bzip2Stream(StreamPtr source);
  ~Bzip2Stream() override;
  Result<size_t> read(std::span<std::byte> out) override;
  [[nodiscard]] uint64_t at_most() const override;

 private:
  Status refill();
  Status begin_next_part();

  StreamPtr source_;
  bz_stream state_{};
  bool ended_ = false;
  std::array<std::byte, size_t{1} << 14> input_;
};

}  // namespace surfcast::stream
