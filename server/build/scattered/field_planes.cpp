#include "scattered/field_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

#include "base/contract.h"

namespace surfcast::scattered {
namespace {

/// Steps of a coarser lattice to the deviation of the kernels that it holds: in the middle between its samples
/// interpolation of degree five is off by 1e-4 of a Gaussian's peak.
constexpr double kCoarseSteps = 3;
/// Rows of a slab that one thread works on.
constexpr uint32_t kTileRows = 16;

/// The whole numbers of an axis within `half` of a place in steps: [first, last), within [begin, end).
struct IndexRange {
  uint32_t first = 0;
  uint32_t last = 0;
};

IndexRange range_of(double place, double half, uint32_t begin, uint32_t end) {
  const auto clamped = [&](double at) {
    return static_cast<uint32_t>(std::clamp(at, static_cast<double>(begin), static_cast<double>(end)));
  };
  return {clamped(std::ceil(place - half)), clamped(std::floor(place + half) + 1)};
}

/// A kernel in steps of the lattice: r^2 = d^T Q d.
struct Quadric {
  glm::dvec3 centre;
  glm::dvec3 half;
  glm::dmat3 matrix;
};

Quadric quadric_of(const KernelSample& sample, Profile profile, const FieldLattice& lattice) {
  const double step = lattice.step;
  return {(sample.centre - lattice.origin) / step, sample.half_extent(profile) / step,
          glm::inverse(sample.shape.matrix() / (step * step))};
}

/// r^2 along a row: a x^2 + 2 b x + c with x from the kernel's centre.
struct RowQuadric {
  double a = 0;
  double b = 0;
  double c = 0;

  [[nodiscard]] double at(double x) const { return (a * x + 2 * b) * x + c; }
};

RowQuadric row_of(const Quadric& kernel, uint32_t j, uint32_t k) {
  const glm::dmat3& q = kernel.matrix;
  const double y = j - kernel.centre.y;
  const double z = k - kernel.centre.z;
  return {q[0][0], q[0][1] * y + q[0][2] * z, q[1][1] * y * y + 2 * q[1][2] * y * z + q[2][2] * z * z};
}

/// The samples of a row within reach of the kernel.
IndexRange reach_in_row(const RowQuadric& row, double centre, Profile profile, uint32_t size) {
  const double squared_reach = reach_of(profile) * reach_of(profile);
  const double discriminant = row.b * row.b - row.a * (row.c - squared_reach);
  if (!(discriminant > 0)) return {};
  return range_of(centre - row.b / row.a, std::sqrt(discriminant) / row.a, 0, size);
}

/// Calls use(i, W / W(0)) along a row. A Gaussian along a line is a product of ratios that themselves change by a
/// constant ratio, so it takes no exponential for each sample; rounding grows with the square of their number, 1e-10
/// after 1000.
template <typename Use>
void for_gaussian_row(const RowQuadric& row, double centre, const IndexRange& range, const Use& use) {
  const double x = range.first - centre;
  double value = std::exp(-0.5 * row.at(x));
  double ratio = std::exp(-0.5 * (row.a * (2 * x + 1) + 2 * row.b));
  const double ratio_of_ratios = std::exp(-row.a);
  for (uint32_t i = range.first; i < range.last; ++i) {
    use(i, value);
    value *= ratio;
    ratio *= ratio_of_ratios;
  }
}

template <typename Use>
void for_spline_row(const RowQuadric& row, double centre, const IndexRange& range, const Use& use) {
  for (uint32_t i = range.first; i < range.last; ++i) {
    use(i, profile_at(Profile::kSpline, std::max(row.at(i - centre), 0.0)));
  }
}

template <typename Use>
void for_row(Profile profile, const RowQuadric& row, double centre, const IndexRange& range, const Use& use) {
  if (profile == Profile::kGaussian) return for_gaussian_row(row, centre, range, use);
  for_spline_row(row, centre, range, use);
}

/// The same box with 2^level times the step.
FieldLattice coarser(const FieldLattice& lattice, size_t level) {
  FieldLattice coarse = lattice;
  coarse.step *= std::exp2(static_cast<double>(level));
  const uint32_t steps = uint32_t{1} << level;
  coarse.size = (lattice.size - 1U + (steps - 1)) / steps + 1U;
  return coarse;
}

/// The samples of each level: the coarsest lattice that resolves a kernel well. At least one level.
std::vector<std::vector<uint32_t>> by_level(const Samples& samples, const FieldLattice& lattice) {
  SURFCAST_EXPECTS(samples.kernels.size() < std::numeric_limits<uint32_t>::max());
  std::vector<std::vector<uint32_t>> levels(1);
  const uint32_t longest = std::max({lattice.size.x, lattice.size.y, lattice.size.z});
  for (uint32_t i = 0; i < samples.kernels.size(); ++i) {
    double steps = least_deviation(samples.kernels[i], samples.profile) / lattice.step;
    size_t level = 0;
    for (; steps >= 2 * kCoarseSteps && (longest >> level) > kSlabPlanes; steps /= 2) ++level;
    levels.resize(std::max(levels.size(), level + 1));
    levels[level].push_back(i);
  }
  return levels;
}

/// Weights of the six nearest samples in the middle between two (Lagrange).
constexpr std::array<double, 6> kMiddle{3.0 / 256, -25.0 / 256, 150.0 / 256, 150.0 / 256, -25.0 / 256, 3.0 / 256};

/// Values between and at the samples of a line, `stride` apart; beyond its ends they are 0, as kernels are there.
/// Value n of the result is that at n / 2.
void interpolate_line(const double* from, size_t stride, size_t count, std::span<double> to) {
  for (size_t n = 0; n < to.size(); ++n) {
    const size_t at = n / 2;
    if (n % 2 == 0) {
      to[n] = from[at * stride];
      continue;
    }
    double value = 0;
    for (size_t tap = 0; tap < kMiddle.size(); ++tap) {
      if (at + tap >= 2 && at + tap - 2 < count) value += kMiddle[tap] * from[(at + tap - 2) * stride];
    }
    to[n] = value;
  }
}

/// Plane n / 2 of a coarse lattice.
std::vector<double> interpolate_plane(std::span<const double> coarse, const glm::u32vec3& size, uint32_t n) {
  const size_t plane = size_t{size.x} * size.y;
  const auto of = [&](size_t k) { return coarse.subspan(k * plane, plane); };
  if (n % 2 == 0) return {of(n / 2).begin(), of(n / 2).end()};
  std::vector<double> result(plane);
  for (size_t tap = 0; tap < kMiddle.size(); ++tap) {
    const size_t k = n / 2 + tap;
    if (k < 2 || k - 2 >= size.z) continue;
    const std::span from = of(k - 2);
    for (size_t i = 0; i < plane; ++i) result[i] += kMiddle[tap] * from[i];
  }
  return result;
}

/// Adds what a coarse lattice says to one plane of the lattice of half the step.
void add_plane(std::span<const double> coarse, const glm::u32vec3& coarse_size, const glm::u32vec3& size, uint32_t k,
               std::span<double> plane) {
  const std::vector<double> middle = interpolate_plane(coarse, coarse_size, k);
  // Rows first, as they are next to each other, then columns.
  std::vector<double> rows(size_t{size.x} * coarse_size.y);
  for (size_t j = 0; j < coarse_size.y; ++j) {
    interpolate_line(&middle[j * coarse_size.x], 1, coarse_size.x, std::span(rows).subspan(j * size.x, size.x));
  }
  std::vector<double> column(size.y);
  for (size_t i = 0; i < size.x; ++i) {
    interpolate_line(&rows[i], size.x, coarse_size.y, column);
    for (size_t j = 0; j < size.y; ++j) plane[j * size.x + i] += column[j];
  }
}

/// Adds what a coarse lattice says, if there is one, to planes of the lattice of half the step, from `first` on.
void add_interpolated(const KernelSums& coarse, const glm::u32vec3& coarse_size, const glm::u32vec3& size,
                      uint32_t first, KernelSums& planes) {
  if (coarse.sums.empty()) return;
  const size_t plane = size_t{size.x} * size.y;
  oneapi::tbb::parallel_for(size_t{0}, planes.sums.size() / plane, [&](size_t k) {
    const auto number = first + static_cast<uint32_t>(k);
    add_plane(coarse.sums, coarse_size, size, number, std::span(planes.sums).subspan(k * plane, plane));
    if (planes.weights.empty()) return;
    add_plane(coarse.weights, coarse_size, size, number, std::span(planes.weights).subspan(k * plane, plane));
  });
}

double combined(const Combining& combining, double sum, double weight) {
  if (combining.combination != Combination::kAverage) return sum;
  const double least = combining.least_weight;
  return (sum + combining.background * std::max(least - weight, 0.0)) / std::max(weight, least);
}

}  // namespace

/// Some rows of a slab.
struct KernelLevel::Tile {
  IndexRange rows;
  IndexRange planes;
  size_t first = 0;  ///< of the slab's sums, that of the tile's first row
  size_t plane = 0;  ///< from plane to plane
  KernelSums& slab;
};

Combining combining_of(const FieldOptions& options, const Samples& samples) {
  const auto lowest = std::ranges::min_element(samples.kernels, {}, &KernelSample::value);
  return {options.combination, options.background.value_or(lowest->value), options.least_weight};
}

KernelLevel::KernelLevel(const Samples& samples, std::span<const uint32_t> members, const FieldLattice& lattice,
                         bool weights)
    : samples_(samples), lattice_(lattice), weights_(weights), first_(size_t{slabs()} + 1) {
  const auto slabs_of = [this](uint32_t member) {
    const KernelSample& sample = samples_.kernels[member];
    const double half = sample.half_extent(samples_.profile).z / lattice_.step;
    const IndexRange planes = range_of((sample.centre.z - lattice_.origin.z) / lattice_.step, half, 0, lattice_.size.z);
    if (planes.first >= planes.last) return IndexRange{};
    return IndexRange{planes.first / kSlabPlanes, (planes.last - 1) / kSlabPlanes + 1};
  };
  for (const uint32_t member : members) {
    const IndexRange range = slabs_of(member);
    for (uint32_t slab = range.first; slab < range.last; ++slab) ++first_[slab + 1];
  }
  for (size_t slab = 1; slab < first_.size(); ++slab) first_[slab] += first_[slab - 1];
  members_.resize(first_.back());
  std::vector<uint64_t> next(first_.begin(), first_.end() - 1);
  for (const uint32_t member : members) {
    const IndexRange range = slabs_of(member);
    for (uint32_t slab = range.first; slab < range.last; ++slab) members_[next[slab]++] = member;
  }
}

uint32_t KernelLevel::planes_of(uint32_t slab) const {
  return std::min(kSlabPlanes, lattice_.size.z - slab * kSlabPlanes);
}

KernelSums KernelLevel::evaluate(uint32_t slab) const {
  const uint32_t planes = planes_of(slab);
  const size_t plane = size_t{lattice_.size.x} * lattice_.size.y;
  KernelSums result{std::vector<double>(plane * planes), std::vector<double>(weights_ ? plane * planes : 0)};
  const std::span members = std::span(members_).subspan(first_[slab], first_[slab + 1] - first_[slab]);
  const uint32_t tiles = (lattice_.size.y + kTileRows - 1) / kTileRows;
  oneapi::tbb::parallel_for(uint32_t{0}, tiles, [&](uint32_t number) {
    Tile tile{{number * kTileRows, std::min((number + 1) * kTileRows, lattice_.size.y)},
              {slab * kSlabPlanes, slab * kSlabPlanes + planes},
              size_t{number} * kTileRows * lattice_.size.x,
              plane,
              result};
    for (const uint32_t member : members) add(samples_.kernels[member], tile);
  });
  return result;
}

void KernelLevel::add(const KernelSample& sample, Tile& tile) const {
  const double half = sample.half_extent(samples_.profile).y / lattice_.step;
  const double row_place = (sample.centre.y - lattice_.origin.y) / lattice_.step;
  const IndexRange rows = range_of(row_place, half, tile.rows.first, tile.rows.last);
  if (rows.first >= rows.last) return;
  const Quadric kernel = quadric_of(sample, samples_.profile, lattice_);
  const IndexRange planes = range_of(kernel.centre.z, kernel.half.z, tile.planes.first, tile.planes.last);
  for (uint32_t k = planes.first; k < planes.last; ++k) {
    for (uint32_t j = rows.first; j < rows.last; ++j) {
      const RowQuadric row = row_of(kernel, j, k);
      const IndexRange range = reach_in_row(row, kernel.centre.x, samples_.profile, lattice_.size.x);
      if (range.first >= range.last) continue;
      const size_t at =
          tile.first + (k - tile.planes.first) * tile.plane + size_t{j - tile.rows.first} * lattice_.size.x;
      double* sums = &tile.slab.sums[at];
      double* weights = weights_ ? &tile.slab.weights[at] : nullptr;
      for_row(samples_.profile, row, kernel.centre.x, range, [&](uint32_t i, double profile) {
        const double weight = sample.amplitude * profile;
        sums[i] += weight * sample.value;
        if (weights != nullptr) weights[i] += weight;
      });
    }
  }
}

FieldPlanes::FieldPlanes(const Samples& samples, const FieldLattice& lattice, const Combining& combining)
    : FieldPlanes(samples, lattice, combining, by_level(samples, lattice)) {}

FieldPlanes::FieldPlanes(const Samples& samples, const FieldLattice& lattice, const Combining& combining,
                         const std::vector<std::vector<uint32_t>>& levels)
    : combining_(combining),
      finest_(samples, levels[0], lattice, combining.combination == Combination::kAverage),
      levels_(levels.size()) {
  const bool weights = combining.combination == Combination::kAverage;
  for (size_t level = levels.size() - 1; level > 0; --level) {
    const KernelLevel kernels(samples, levels[level], coarser(lattice, level), weights);
    KernelSums sums;
    for (uint32_t slab = 0; slab < kernels.slabs(); ++slab) {
      KernelSums planes = kernels.evaluate(slab);
      add_interpolated(coarse_, coarse_size_, kernels.lattice().size, slab * kSlabPlanes, planes);
      sums.sums.insert(sums.sums.end(), planes.sums.begin(), planes.sums.end());
      sums.weights.insert(sums.weights.end(), planes.weights.begin(), planes.weights.end());
    }
    coarse_ = std::move(sums);
    coarse_size_ = kernels.lattice().size;
  }
}

uint64_t FieldPlanes::bytes_for(const FieldLattice& lattice) {
  // An eighth of the samples, and an eighth of these while they are made; each with a sum and a weight.
  return lattice.samples() / 7 * 2 * sizeof(double);
}

void FieldPlanes::evaluate(uint32_t slab, std::span<float> values) const {
  KernelSums sums = finest_.evaluate(slab);
  SURFCAST_EXPECTS(values.size() == sums.sums.size());
  add_interpolated(coarse_, coarse_size_, finest_.lattice().size, slab * kSlabPlanes, sums);
  for (size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(combined(combining_, sums.sums[i], sums.weights.empty() ? 0 : sums.weights[i]));
  }
}

}  // namespace surfcast::scattered
