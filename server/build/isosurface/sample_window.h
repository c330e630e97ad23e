#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <glm/ext/vector_int3_sized.hpp>
#include <span>
#include <vector>

namespace surfcast::isosurface {

/// A place of a grid: sample numbers along i, j and k.
using Index = glm::i64vec3;

/// Consecutive planes of a grid, k after k, in memory. A place beyond a face of the grid means the sample at the face.
class SampleWindow {
 public:
  explicit SampleWindow(const Index& size) : size_(size) {}

  [[nodiscard]] const Index& size() const { return size_; }
  /// The planes in memory: from `first` to `end` - 1.
  [[nodiscard]] int64_t first() const { return first_; }
  [[nodiscard]] int64_t end() const { return first_ + static_cast<int64_t>(planes_.size()); }
  [[nodiscard]] size_t plane_samples() const { return static_cast<size_t>(size_.x * size_.y); }

  /// The next plane, for its samples: i fastest, then j.
  std::span<double> append();
  void drop_before(int64_t plane);

  /// The samples of a row. The plane nearest to `k` in the grid must be in memory.
  [[nodiscard]] std::span<const double> row(int64_t j, int64_t k) const;

 private:
  Index size_;
  int64_t first_ = 0;
  std::deque<std::vector<double>> planes_;
  std::vector<double> spare_;  ///< memory of a dropped plane
};

}  // namespace surfcast::isosurface
