#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace surfcast::lab {

/// The usable points of a scan at distinct positions: of points at one position the first. Columns that the scan does
/// not have are empty.
struct LabPoints {
  std::vector<glm::dvec3> positions;
  std::vector<glm::u8vec3> colors;  ///< sRGB
  std::vector<float> intensities;
  std::vector<glm::vec3> normals;  ///< as stored
  bool z_up = true;

  [[nodiscard]] size_t size() const { return positions.size(); }
};

Result<LabPoints> read_points(const std::filesystem::path& scan);

/// The points whose `keep` is true.
LabPoints kept_points(const LabPoints& points, const std::vector<bool>& keep);

/// Writes binary PLY, with positions in double precision and without radii. False if the file cannot be written.
bool write_ply(const LabPoints& points, const std::filesystem::path& path);

/// Grey levels by intensity, from the second to the 98th percentile.
std::vector<glm::u8vec3> intensity_levels(const std::vector<float>& intensities);

}  // namespace surfcast::lab
