#pragma once

#include <string_view>

namespace surfcast::ldc {

/// True for the scalar attributes that coarse surfels have: intensity, which is averaged, and classification, of which
/// the class of the largest area is kept. Of others (times, numbers of returns) no average means anything.
inline bool is_coarse_scalar(std::string_view name) {
  return name == "intensity" || name == "classification";
}

}  // namespace surfcast::ldc
