#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace surfcast::testing {

/// A line of a text scan.
inline std::string xyz_line(double x, double y, double z) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%.9f %.9f %.9f\n", x, y, z);
  return text.data();
}

}  // namespace surfcast::testing
