#pragma once

#include <cstddef>
#include <span>

#include "laz/arithmetic_decoder.h"

namespace surfcast::laz {

/// The bytes of a chunk that encode one field of its points. Empty if the field never changes.
struct Layer {
  Layer() = default;
  explicit Layer(std::span<const std::byte> bytes) : present(!bytes.empty()) {
    if (present) in = ArithmeticDecoder(bytes);
  }

  [[nodiscard]] bool damaged() const { return present && in.damaged(); }

  bool present = false;
  ArithmeticDecoder in;
};

}  // namespace surfcast::laz
