#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/result.h"
#include "volume/brick.h"

namespace surfcast::volume {

/// What samples mean: value = slope * sample + intercept.
struct SampleScale {
  double slope = 1;
  double intercept = 0;
  /// All samples are multiples of `step`, or may be rounded to them. 0: they may be any numbers.
  double step = 0;
};

/// A brick of samples with their halo, in the order of Brick::codes. `place` has the members before `offset`. Samples
/// are finite. Codes count steps if 65535 suffice for the range of the brick; otherwise they divide that range.
[[nodiscard]] Brick make_brick(const BrickHeader& place, std::span<const double> samples, const SampleScale& scale);

/// The bytes of a block (docs/model-format.md).
[[nodiscard]] std::vector<std::byte> encode_brick(const Brick& brick);

/// Decodes a brick. `place` has the members before `offset`. Fails on any bytes that encode_brick does not write.
[[nodiscard]] Result<Brick> decode_brick(std::span<const std::byte> bytes, const BrickHeader& place);

}  // namespace surfcast::volume
