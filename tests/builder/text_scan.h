#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <glm/vec3.hpp>
#include <random>
#include <string>
#include <vector>

#include "scan/shapes.h"

namespace surfcast::builder {

/// A scan as text: columns x y z and more.
struct TextScan {
  std::string header = "x y z number intensity";
  std::vector<std::string> rows;

  void add(const glm::dvec3& p, const std::string& more) {
    std::array<char, 160> row{};
    std::snprintf(row.data(), row.size(), "%.17g %.17g %.17g %s", p.x, p.y, p.z, more.c_str());
    rows.emplace_back(row.data());
  }
  void write(const std::filesystem::path& path) const {
    std::ofstream stream(path);
    stream << header << '\n';
    for (const std::string& row : rows) stream << row << '\n';
  }
};

/// Numbers the points from `first` on.
inline TextScan numbered(const std::vector<glm::dvec3>& positions, size_t first = 0) {
  TextScan scan;
  for (size_t i = 0; i < positions.size(); ++i) {
    scan.add(positions[i], std::to_string(first + i) + " " + std::to_string(i * 7 % 256));
  }
  return scan;
}

/// Hills under a dome, so that there are normals of all directions and two surfaces that come close to each other.
inline std::vector<glm::dvec3> hills_and_dome(int side) {
  std::vector<glm::dvec3> positions;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const glm::dvec3 p(x + jitter(random), y + jitter(random), 0);
      positions.push_back(p + glm::dvec3(0, 0, 4 * std::sin(p.x / 15) * std::cos(p.y / 19)));
    }
  }
  const double radius = side / 4.0;
  for (const glm::dvec3& p : testing::sphere(static_cast<int>(12.5 * radius * radius), glm::dvec3(0), radius)) {
    positions.push_back(p + glm::dvec3(side / 2.0, side / 2.0, radius + 6));
  }
  return positions;
}

}  // namespace surfcast::builder
