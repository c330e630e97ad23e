#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace surfcast::testing {

inline std::string bytes_in(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// A wavy square of points, as binary PLY. `from`: the lowest x.
inline void write_waves_from(const std::filesystem::path& path, int side, int from) {
  std::ofstream scan(path, std::ios::binary);
  scan << "ply\nformat binary_little_endian 1.0\nelement vertex " << side * side
       << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  for (int i = 0; i < side * side; ++i) {
    const int row = i / side;
    const auto x = static_cast<float>(from + i % side), y = static_cast<float>(row);
    const float point[] = {x, y, std::sin(x / 9) * std::cos(y / 7)};
    scan.write(reinterpret_cast<const char*>(point), sizeof(point));
  }
}

inline void write_waves(const std::filesystem::path& path, int side) {
  write_waves_from(path, side, 0);
}

}  // namespace surfcast::testing
