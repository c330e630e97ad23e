#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <utility>

namespace surfcast::estimation {

/// A neighbour: its squared distance and its number. Neighbours are sorted by distance, then by number.
using Found = std::pair<double, uint32_t>;

/// The distance of points, squared: the same expression wherever distances are compared, so that rounding never
/// excludes a neighbour.
inline double squared_distance(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 d = a - b;
  return glm::dot(d, d);
}

/// The nearest neighbours found so far, at most `degree` of them, which is at most `Largest`.
template <size_t Largest>
class NearestList {
 public:
  explicit NearestList(size_t degree) : degree_(degree) {}

  void add(const Found& found) {
    if (full() && !(found < all_[count_ - 1])) return;
    size_t at = full() ? count_ - 1 : count_++;
    for (; at > 0 && found < all_[at - 1]; --at) all_[at] = all_[at - 1];
    all_[at] = found;
  }
  [[nodiscard]] bool full() const { return count_ == degree_; }
  /// The squared distance beyond which nothing belongs to the list.
  [[nodiscard]] double bound() const {
    return full() ? all_[count_ - 1].first : std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] std::span<const Found> all() const { return {all_.data(), count_}; }

 private:
  size_t degree_;
  size_t count_ = 0;
  std::array<Found, Largest> all_{};
};

}  // namespace surfcast::estimation
