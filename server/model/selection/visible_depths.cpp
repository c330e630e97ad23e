#include "selection/visible_depths.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/contract.h"

namespace surfcast::selection {
namespace {

/// Cells, at most: one for each pixel of usual pictures.
constexpr double kMostCells = 1 << 20;
/// Cells of a box that are looked at, about.
constexpr int kSamples = 2048;

/// A box as a picture sees it.
struct Projection {
  glm::dvec2 low{std::numeric_limits<double>::infinity()};    ///< pixels
  glm::dvec2 high{-std::numeric_limits<double>::infinity()};  ///< pixels
  double nearest = 0;                                         ///< camera z
  double farthest = 0;                                        ///< likewise
};

/// None if a part of the box is beside or behind the eye.
std::optional<Projection> project(const geometry::Box& box, double margin, const geometry::CameraFrame& frame) {
  const glm::dvec3 centre = frame.to_camera(box.centre());
  const glm::dvec3 half = 0.5 * box.size() + margin;
  const glm::dvec3 x = half.x * frame.rotate({1, 0, 0});
  const glm::dvec3 y = half.y * frame.rotate({0, 1, 0});
  const glm::dvec3 z = half.z * frame.rotate({0, 0, 1});
  const double extent = std::abs(x.z) + std::abs(y.z) + std::abs(z.z);
  if (!(centre.z > extent)) return std::nullopt;
  Projection projection;
  projection.nearest = centre.z - extent;
  projection.farthest = centre.z + extent;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at = centre + (corner & 1 ? x : -x) + (corner & 2 ? y : -y) + (corner & 4 ? z : -z);
    const glm::dvec2 pixel = frame.project(at);
    projection.low = glm::min(projection.low, pixel);
    projection.high = glm::max(projection.high, pixel);
  }
  return projection;
}

/// The cell of a coordinate, moved to the picture's border if it is outside.
int cell_of(double pixel, int side, int cells) {
  return static_cast<int>(std::clamp(pixel / side, 0.0, cells - 1.0));
}

}  // namespace

VisibleDepths::VisibleDepths(int width, int height, double spacing)
    : spacing_(spacing),
      cell_(static_cast<int>(std::ceil(std::sqrt(static_cast<double>(width) * height / kMostCells)))),
      across_((width + cell_ - 1) / cell_),
      down_((height + cell_ - 1) / cell_),
      cells_(static_cast<size_t>(across_) * static_cast<size_t>(down_),
             DepthRange{0, std::numeric_limits<float>::infinity()}) {
  SURFCAST_EXPECTS(width > 0 && height > 0);
}

void VisibleDepths::enter(int x, int y, std::span<const DepthRange> pixels) {
  DepthRange* row = cells_.data() + static_cast<ptrdiff_t>(y / cell_) * across_;
  for (const DepthRange& pixel : pixels) {
    DepthRange& cell = row[x++ / cell_];
    cell.front = std::max(cell.front, pixel.front);
    cell.opaque = std::min(cell.opaque, pixel.opaque);
  }
}

bool VisibleDepths::may_show(const glm::dvec2& pixel, double z, const geometry::CameraFrame& frame) const {
  // The surfel and that which hides it may each be off by as much.
  const double tolerance = 1 + 2 * spacing_ / frame.eta;
  const auto x = static_cast<ptrdiff_t>(cell_of(pixel.x, cell_, across_));
  const auto y = static_cast<ptrdiff_t>(cell_of(pixel.y, cell_, down_));
  return cells_[static_cast<size_t>(y * across_ + x)].opaque <= static_cast<float>(tolerance / z);
}

double VisibleDepths::share_of(const geometry::Box& box, double margin, const geometry::CameraFrame& frame) const {
  const std::optional<Projection> projection = project(box, margin, frame);
  if (!projection) return 1;
  // Surfels of the picture stand for others up to so far away.
  const double tolerance = 1 + spacing_ / frame.eta;
  const auto nearest = static_cast<float>(tolerance / projection->nearest);
  const auto farthest = static_cast<float>(1 / (tolerance * projection->farthest));
  const int left = cell_of(projection->low.x, cell_, across_);
  const int right = cell_of(projection->high.x, cell_, across_);
  const int top = cell_of(projection->low.y, cell_, down_);
  const int bottom = cell_of(projection->high.y, cell_, down_);
  const double cells = static_cast<double>(right - left + 1) * (bottom - top + 1);
  const int step = std::max(1, static_cast<int>(std::sqrt(cells / kSamples)));
  size_t seen = 0;
  size_t samples = 0;
  for (int y = top; y <= bottom; y += step) {
    const DepthRange* row = cells_.data() + static_cast<ptrdiff_t>(y) * across_;
    for (int x = left; x <= right; x += step) {
      seen += row[x].opaque <= nearest && row[x].front >= farthest ? 1 : 0;
      ++samples;
    }
  }
  return static_cast<double>(seen) / static_cast<double>(samples);
}

}  // namespace surfcast::selection
