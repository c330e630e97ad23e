#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

namespace surfcast::bench {

/// One echo of the generated scan.
struct Echo {
  glm::dvec3 position{0};  ///< metres from the corner of the scene
  glm::u16vec3 color{0};   ///< sRGB, 16 bit
  uint16_t intensity = 0;
  uint8_t classification = 0;  ///< as LAS numbers them: 2 ground, 5 high vegetation, 6 building
  uint8_t return_number = 1;
  uint8_t returns = 1;
};

enum class Landscape : uint8_t { kTown, kForest };

/// A square kilometre of town and parkland on rolling ground: blocks of 40 m with houses, trees or meadow between
/// streets, scanned from the air and, for the walls, from the street. The scene is computed from hashes of positions.
/// Scans with different numbers of echoes therefore differ only in their density. The forest covers the banks and
/// foundations of a ring fort in the middle of the square.
inline constexpr double kSceneSide = 1000;

/// Echo `index` of `count`. Echoes are in the order of a survey: row by row.
Echo scan_echo(uint64_t index, uint64_t count, Landscape landscape = Landscape::kTown);

/// The echoes of a rectangle of the scene: parts of successive rows.
struct ScanPart {
  uint64_t count = 0;  ///< of the whole scan
  uint64_t columns = 0;
  uint64_t first_row = 0;
  uint64_t rows = 0;  ///< of the part
  uint64_t first_column = 0;
  uint64_t width = 0;  ///< of a row of the part
  uint64_t last = 0;   ///< echoes that the last row lacks, because the scan ends there

  [[nodiscard]] uint64_t size() const { return rows * width - last; }
  /// Index in the whole scan of echo `i` of the part.
  [[nodiscard]] uint64_t index(uint64_t i) const {
    return (first_row + i / width) * columns + first_column + i % width;
  }
};

/// The part of a scan of `count` echoes over the square with the corner x, y and this side, metres. It is cut off where
/// the scene ends.
ScanPart part_of_scan(uint64_t count, double x, double y, double side);

}  // namespace surfcast::bench
