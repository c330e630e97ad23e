#include "isosurface/sample_window.h"

#include <algorithm>
#include <utility>

#include "base/contract.h"

namespace surfcast::isosurface {

std::span<double> SampleWindow::append() {
  SURFCAST_EXPECTS(end() < size_.z);
  planes_.push_back(std::exchange(spare_, {}));
  planes_.back().resize(plane_samples());
  return planes_.back();
}

void SampleWindow::drop_before(int64_t plane) {
  for (; first_ < plane && !planes_.empty(); ++first_) {
    spare_ = std::move(planes_.front());
    planes_.pop_front();
  }
}

std::span<const double> SampleWindow::row(int64_t j, int64_t k) const {
  const int64_t plane = std::clamp<int64_t>(k, 0, size_.z - 1) - first_;
  SURFCAST_EXPECTS(plane >= 0 && plane < static_cast<int64_t>(planes_.size()));
  const int64_t at = std::clamp<int64_t>(j, 0, size_.y - 1) * size_.x;
  return std::span(planes_[static_cast<size_t>(plane)]).subspan(static_cast<size_t>(at), static_cast<size_t>(size_.x));
}

}  // namespace surfcast::isosurface
