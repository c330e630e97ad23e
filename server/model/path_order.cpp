#include "model/path_order.h"

#include <algorithm>
#include <array>

namespace surfcast::model {
namespace {

/// Number of candidates for the next point. More give a shorter path; the time grows in proportion.
constexpr size_t kWindow = 128;

/// Points not yet visited, as arrays so that the compiler can use vector instructions on them.
class Window {
 public:
  [[nodiscard]] bool full() const { return size_ == kWindow; }
  [[nodiscard]] bool empty() const { return size_ == 0; }

  void add(uint32_t number, const glm::ivec3& point) {
    x_[size_] = static_cast<float>(point.x);
    y_[size_] = static_cast<float>(point.y);
    z_[size_] = static_cast<float>(point.z);
    numbers_[size_++] = number;
  }

  /// Removes the point nearest to `from` and moves `from` there.
  uint32_t take_nearest(glm::vec3& from) {
    std::array<float, kWindow> distances;
    for (size_t i = 0; i < size_; ++i) {
      const float dx = x_[i] - from.x;
      const float dy = y_[i] - from.y;
      const float dz = z_[i] - from.z;
      distances[i] = dx * dx + dy * dy + dz * dz;
    }
    const auto* nearest = std::min_element(distances.data(), distances.data() + size_);
    return take(static_cast<size_t>(nearest - distances.data()), from);
  }

 private:
  uint32_t take(size_t i, glm::vec3& at) {
    at = {x_[i], y_[i], z_[i]};
    const uint32_t number = numbers_[i];
    --size_;
    x_[i] = x_[size_];
    y_[i] = y_[size_];
    z_[i] = z_[size_];
    numbers_[i] = numbers_[size_];
    return number;
  }

  size_t size_ = 0;
  std::array<float, kWindow> x_{};
  std::array<float, kWindow> y_{};
  std::array<float, kWindow> z_{};
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
