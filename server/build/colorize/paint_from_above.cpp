#include "colorize/paint_from_above.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mesh/texel_color.h"
#include "surfel/srgb.h"

namespace surfcast::colorize {
namespace {

using scan::ScanPoints;

constexpr double kHigher = 3;  ///< spacings by which something that hides a point is above it

/// The greatest heights of a scan in squares of one spacing.
class HeightMap {
 public:
  static Result<HeightMap> of(const scan::ScanStream& scan, const scan::DecodingLimit& limit) {
    HeightMap map(scan);
    if (Status status = limit.check(map.columns_ * map.rows_ * sizeof(float)); !status) return fail(status);
    map.heights_.assign(map.columns_ * map.rows_, -std::numeric_limits<float>::infinity());
    for (size_t piece = 0; piece < scan.pieces(); ++piece) {
      const Result<ScanPoints> points = scan.read(piece);
      if (!points) return fail(points);
      for (const glm::dvec3& p : points->positions) map.add(p);
    }
    return map;
  }

  [[nodiscard]] double spacing() const { return spacing_; }

  /// The greatest height around.
  [[nodiscard]] double above(const glm::dvec3& p) const {
    const auto [x, y] = cell_of(p);
    float most = -std::numeric_limits<float>::infinity();
    for (size_t j = y - std::min<size_t>(y, 1); j <= std::min(y + 1, rows_ - 1); ++j) {
      for (size_t i = x - std::min<size_t>(x, 1); i <= std::min(x + 1, columns_ - 1); ++i) {
        most = std::max(most, heights_[j * columns_ + i]);
      }
    }
    return low_.z + double{most};
  }

 private:
  explicit HeightMap(const scan::ScanStream& scan) : low_(scan.bounds().min) {
    const glm::dvec3 size = scan.bounds().size();
    const double longest = std::max({size.x, size.y, 1e-300});
    const double area = std::max(size.x, longest * 1e-3) * std::max(size.y, longest * 1e-3);
    spacing_ = std::sqrt(area / static_cast<double>(std::max<uint64_t>(scan.size(), 1)));
    columns_ = static_cast<size_t>(size.x / spacing_) + 1;
    rows_ = static_cast<size_t>(size.y / spacing_) + 1;
  }

  [[nodiscard]] std::pair<size_t, size_t> cell_of(const glm::dvec3& p) const {
    const auto cell = [this](double offset, size_t count) {
      return static_cast<size_t>(std::clamp(offset / spacing_, 0.0, static_cast<double>(count - 1)));
    };
    return {cell(p.x - low_.x, columns_), cell(p.y - low_.y, rows_)};
  }

  void add(const glm::dvec3& p) {
    if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) return;
    const auto [x, y] = cell_of(p);
    float& height = heights_[y * columns_ + x];
    height = std::max(height, static_cast<float>(p.z - low_.z));
  }

  glm::dvec3 low_;
  double spacing_ = 1;
  size_t columns_ = 1;
  size_t rows_ = 1;
  std::vector<float> heights_;
};

Paint paint(const GeoPhoto& photo, const HeightMap& heights, const glm::dvec3& p, glm::u8vec3& color) {
  const mesh::Texture& texture = photo.texture;
  const glm::dvec2 pixel = photo.frame.pixel_of(glm::dvec2(p));
  const bool inside = pixel.x >= 0 && pixel.y >= 0 && pixel.x < static_cast<double>(texture.width) &&
                      pixel.y < static_cast<double>(texture.height);
  if (!inside) return Paint::kOutside;
  if (heights.above(p) > p.z + kHigher * heights.spacing()) return Paint::kHidden;
  const double side = heights.spacing() / photo.frame.pixel_side();
  const mesh::TexelArea area{pixel, glm::dvec2(side < 1 ? 0 : std::round(side))};
  const glm::vec4 light = mesh::mean_light(texture, area, {mesh::Wrap::kClamp, mesh::Wrap::kClamp}, false, nullptr, 0);
  if (light.a == 0) return Paint::kOutside;  // no data
  color = glm::u8vec3(surfel::from_linear(glm::vec3(light), 8));
  return Paint::kPainted;
}

}  // namespace

Result<scan::ScanStream> paint_from_above(scan::ScanStream scan, const std::filesystem::path& path,
                                          const GeoPhoto& photo, const scan::DecodingLimit& limit,
                                          std::optional<uint64_t> sample, PaintReport& report) {
  Result<HeightMap> heights = HeightMap::of(scan, limit);
  if (!heights) return fail_about(path.string(), heights);
  const Painter painter = [&photo, map = std::make_shared<const HeightMap>(std::move(*heights))](
                              const glm::dvec3& p, glm::u8vec3& color) { return paint(photo, *map, p, color); };
  return paint_scan(std::move(scan), path, painter, sample, report);
}

}  // namespace surfcast::colorize
