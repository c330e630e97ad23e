#include "service/encode_times.h"

#include <algorithm>
#include <vector>

namespace surfcast::service {

void EncodeTimes::record(picture::FileFormat format, size_t pixels, double milliseconds) {
  constexpr size_t kPictures = 9;
  if (pixels == 0) return;
  const std::lock_guard lock(mutex_);
  std::deque<double>& times = of_a_pixel_.at(static_cast<size_t>(format));
  times.push_back(milliseconds / static_cast<double>(pixels));
  if (times.size() > kPictures) times.pop_front();
}

std::optional<double> EncodeTimes::expected_ms(picture::FileFormat format, size_t pixels) const {
  const std::lock_guard lock(mutex_);
  const std::deque<double>& times = of_a_pixel_.at(static_cast<size_t>(format));
  if (times.empty()) return std::nullopt;
  std::vector<double> sorted(times.begin(), times.end());
  std::ranges::sort(sorted);
  return sorted[sorted.size() / 2] * static_cast<double>(pixels);
}

}  // namespace surfcast::service
