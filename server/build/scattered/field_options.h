#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"

namespace surfcast::scattered {

/// FieldOptions::least_weight by default.
inline constexpr double kMinWeight = 0.1;

/// How the kernels W of samples with values v make a field. W is 1 at its centre, or its integral is 1.
enum class Combination {
  kSum,      ///< sum of v W, W(0) = 1
  kAverage,  ///< sum of v W / sum of W
  kDensity,  ///< sum of v W, the integral of W is 1: v is a mass
};

/// What states the size of a kernel.
enum class KernelSize {
  kRadius,           ///< the cubic spline of Monaghan and Lattanzio that ends at this distance
  kSmoothingLength,  ///< the same spline, which ends at twice this length
  kDeviation,        ///< a Gaussian, equal in all directions
  kCovariance,       ///< a Gaussian: six columns, NAME_xx NAME_xy NAME_xz NAME_yy NAME_yz NAME_zz
  kSpacing,          ///< the spline, as wide as the distances to the samples around ask for
};

/// The sizes of kernels: a column or a length, world units.
struct KernelSizes {
  KernelSize meaning = KernelSize::kSpacing;
  std::string column;            ///< of kCovariance the part before the underscore
  std::optional<double> length;  ///< of all kernels, instead of a column
};

/// Which columns of a table of points are a field, and how it is sampled.
struct FieldOptions {
  std::string value;                   ///< the column of values
  std::optional<KernelSizes> sizes{};  ///< none: as the names of the columns tell, see usual_sizes()
  std::string weight{};                ///< a column by which kernels are multiplied; empty: none
  Combination combination = Combination::kSum;
  std::optional<uint32_t> resolution{};  ///< samples along the longest axis; none: as the kernels need
  /// Of kAverage: the value where there are no samples; none: the lowest one.
  std::optional<double> background{};
  /// Of kAverage: where the sum of kernels is less, the background has the rest of the weight.
  double least_weight = kMinWeight;
};

/// Parses `radius=COLUMN`, `smoothing=COLUMN`, `sigma=COLUMN`, each also with a length in place of the column,
/// `covariance=PREFIX` or `spacing`.
[[nodiscard]] Result<KernelSizes> parse_kernel_sizes(std::string_view text);

}  // namespace surfcast::scattered
