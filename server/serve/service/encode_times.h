#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>

#include "picture/file_format.h"

namespace surfcast::service {

/// How long pictures take to encode, by what the last ones took. May be used from any thread.
class EncodeTimes {
 public:
  void record(picture::FileFormat format, size_t pixels, double milliseconds);
  /// The median over the last pictures of the format, for so many pixels; none if there were none.
  [[nodiscard]] std::optional<double> expected_ms(picture::FileFormat format, size_t pixels) const;

 private:
  mutable std::mutex mutex_;
  std::array<std::deque<double>, 4> of_a_pixel_;  ///< by format, the newest last
};

}  // namespace surfcast::service
