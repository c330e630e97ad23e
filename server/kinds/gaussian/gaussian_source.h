#pragma once

#include <cstdint>
#include <memory>

#include "base/result.h"
#include "gaussian/gaussians.h"
#include "stream/mapped_stream.h"

namespace surfcast::gaussian {

/// The Gaussians of a file, from the first to the last. Each format has one.
class GaussianSource {
 public:
  GaussianSource() = default;
  GaussianSource(const GaussianSource&) = delete;
  GaussianSource& operator=(const GaussianSource&) = delete;
  virtual ~GaussianSource() = default;

  [[nodiscard]] virtual const GaussianTraits& traits() const = 0;
  /// The Gaussians of rows [first, first + count), as they are stored: rotations need not be of length 1, and numbers
  /// need not be finite. Rows are read in order; only row 0 may follow a later one.
  virtual Result<Gaussians> read(uint64_t first, uint64_t count) = 0;
  /// Memory of what is decoded as a whole, bytes.
  [[nodiscard]] virtual uint64_t held_bytes() const { return 0; }
};

using SourcePtr = std::unique_ptr<GaussianSource>;

/// Columns of that many Gaussians.
[[nodiscard]] Gaussians make_gaussians(uint64_t count, int degree);

/// The nearest float, as a double. A function of its own in a source of its own: GCC 12 leaves out the rounding where
/// it vectorises a conversion to float and back.
[[nodiscard]] double rounded_to_float(double value);

/// 1 / (1 + exp(-x)): 1 and 0 for infinite logits.
[[nodiscard]] float opacity_of_logit(double logit);

}  // namespace surfcast::gaussian
