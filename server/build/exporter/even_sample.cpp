#include "exporter/even_sample.h"

#include <algorithm>
#include <utility>

namespace surfcast::exporter {
namespace {

/// Cells of the grid along each axis. Their side is twice the distance that points keep, so that those too close to a
/// place are in the cells around the nearest corner.
constexpr int kGridCells = static_cast<int>(0.5 / kSampleSpacing);
constexpr uint32_t kNone = UINT32_MAX;

class EvenSampler {
 public:
  explicit EvenSampler(std::span<const SamplePoint> points)
      : points_(points), last_(size_t{kGridCells} * kGridCells * kGridCells, kNone), before_(points.size()) {}

  std::vector<uint32_t> sample() {
    std::vector<std::pair<uint64_t, uint32_t>> order(points_.size());
    for (uint32_t i = 0; i < order.size(); ++i) order[i] = {points_[i].hash, i};
    std::ranges::sort(order);
    std::vector<uint32_t> chosen;
    for (const auto& [hash, point] : order) {
      if (!has_room(points_[point].place)) continue;
      chosen.push_back(point);
      insert(point);
    }
    std::ranges::sort(chosen);
    return chosen;
  }

 private:
  static int clamped(int cell) { return std::clamp(cell, 0, kGridCells - 1); }
  static size_t cell_at(int x, int y, int z) {
    return (static_cast<size_t>(z) * kGridCells + static_cast<size_t>(y)) * kGridCells + static_cast<size_t>(x);
  }

  void insert(uint32_t point) {
    const glm::ivec3 cell(points_[point].place * static_cast<float>(kGridCells));
    uint32_t& last = last_[cell_at(clamped(cell.x), clamped(cell.y), clamped(cell.z))];
    before_[point] = last;
    last = point;
  }

  [[nodiscard]] bool has_room(const glm::vec3& place) const {
    const glm::ivec3 corner(place * static_cast<float>(kGridCells) + 0.5F);
    for (int z = std::max(corner.z - 1, 0); z <= clamped(corner.z); ++z) {
      for (int y = std::max(corner.y - 1, 0); y <= clamped(corner.y); ++y) {
        for (int x = std::max(corner.x - 1, 0); x <= clamped(corner.x); ++x) {
          if (is_close(place, last_[cell_at(x, y, z)])) return false;
        }
      }
    }
    return true;
  }

  /// To a point or one of those before it in its cell.
  [[nodiscard]] bool is_close(const glm::vec3& place, uint32_t point) const {
    constexpr auto kMin = static_cast<float>(kSampleSpacing * kSampleSpacing);
    for (; point != kNone; point = before_[point]) {
      const glm::vec3 way = points_[point].place - place;
      if (way.x * way.x + way.y * way.y + way.z * way.z < kMin) return true;
    }
    return false;
  }

  std::span<const SamplePoint> points_;
  std::vector<uint32_t> last_;    ///< for each cell of the grid the last of its points that was chosen
  std::vector<uint32_t> before_;  ///< for each point that was chosen the one before it in its cell
};

}  // namespace

std::vector<uint32_t> even_sample(std::span<const SamplePoint> points) {
  return EvenSampler(points).sample();
}

}  // namespace surfcast::exporter
