#pragma once

#include <string_view>

namespace surfcast::ldc {

/// True for the scalar attributes of coarse surfels: intensity, which is averaged, and classification, which takes the
/// class of the largest area. An average of the others (times, return numbers) would have no meaning.
inline bool is_coarse_scalar(std::string_view name) {
  return name == "intensity" || name == "classification";
}

}  // namespace surfcast::ldc
