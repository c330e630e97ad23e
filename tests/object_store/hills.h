#pragma once

#include <cmath>
#include <sstream>
#include <string>

namespace surfcast::testing {

/// A coloured surface of `side` x `side` points as PLY. `turn`: of its colours.
inline std::string hills(int side, int turn = 0) {
  std::ostringstream ply;
  ply << "ply\nformat ascii 1.0\nelement vertex " << side * side
      << "\nproperty float x\nproperty float y\nproperty float z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  for (int i = 0; i < side * side; ++i) {
    const int x = i % side;
    const int y = i / side;
    ply << x << ' ' << y << ' ' << std::sin(0.1 * x) * std::cos(0.07 * y) * 5 << ' ' << (x + turn) % 256 << ' ' << y
        << ' ' << (x * y + turn) % 256 << '\n';
  }
  return ply.str();
}

}  // namespace surfcast::testing
