#include "model/path_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "base/vector_clones.h"

namespace surfcast::model {
namespace {

/// Number of candidates for the next point, a power of two. More give a shorter path; the time grows in proportion.
constexpr uint32_t kWindow = 128;

/// Farther from every point than any other point. Its squared distance is infinite.
constexpr float kNowhere = 1e30F;

using Coordinates = std::array<float, kWindow>;

/// The slot of the point nearest to `from`. The lowest bits of a squared distance, seen as an integer, give way to the
/// number of its slot, so that one minimum finds both. Distances that differ by less than 1 in 10^5 count as equal.
SURFCAST_VECTOR_CLONES size_t nearest_slot(const Coordinates& x, const Coordinates& y, const Coordinates& z,
                                           const glm::vec3& from) {
  constexpr uint32_t kSlot = kWindow - 1;
  int32_t least = std::numeric_limits<int32_t>::max();
  for (uint32_t i = 0; i < kWindow; ++i) {
    const float dx = x[i] - from.x;
    const float dy = y[i] - from.y;
    const float dz = z[i] - from.z;
    const auto bits = std::bit_cast<uint32_t>(dx * dx + dy * dy + dz * dz);  // ascending with the distance
    least = std::min(least, static_cast<int32_t>((bits & ~kSlot) | i));
  }
  return static_cast<uint32_t>(least) & kSlot;
}

/// Points not yet visited, as arrays so that the compiler can use vector instructions on them.
class Window {
 public:
  Window() { x_.fill(kNowhere); }

  [[nodiscard]] bool full() const { return size_ == kWindow; }

  void add(uint32_t number, const glm::ivec3& point) {
    x_[size_] = static_cast<float>(point.x);
    y_[size_] = static_cast<float>(point.y);
    z_[size_] = static_cast<float>(point.z);
    numbers_[size_++] = number;
  }

  /// Removes the point nearest to `from` and moves `from` there.
  uint32_t take_nearest(glm::vec3& from) { return take(nearest_slot(x_, y_, z_, from), from); }

 private:
  uint32_t take(size_t i, glm::vec3& at) {
    at = {x_[i], y_[i], z_[i]};
    const uint32_t number = numbers_[i];
    --size_;
    x_[i] = x_[size_];
    y_[i] = y_[size_];
    z_[i] = z_[size_];
    numbers_[i] = numbers_[size_];
    x_[size_] = kNowhere;
    return number;
  }

  size_t size_ = 0;
  Coordinates x_{};
  Coordinates y_{};
  Coordinates z_{};
  std::array<uint32_t, kWindow> numbers_{};
};

}  // namespace

std::vector<uint32_t> path_order(std::span<const glm::ivec3> points) {
  std::vector<uint32_t> order;
  order.reserve(points.size());
  Window window;
  glm::vec3 at = points.empty() ? glm::vec3(0) : glm::vec3(points.front());
  uint32_t next = 0;
  while (order.size() < points.size()) {
    for (; next < points.size() && !window.full(); ++next) window.add(next, points[next]);
    order.push_back(window.take_nearest(at));
  }
  return order;
}

}  // namespace surfcast::model
