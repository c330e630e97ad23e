#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "scan/e57_pages.h"

namespace surfcast::scan {

/// How the values of a field are stored (ASTM E2807-11, 8.3).
enum class E57Coding { kFloat, kDouble, kInteger, kScaled, kString };

/// A value of every point. Its stream has `bits` bits of each point, one point after the other.
struct E57Field {
  std::string name;
  E57Coding coding = E57Coding::kDouble;
  int64_t minimum = 0;  ///< of the stored integer; the stream has the difference to it
  int64_t maximum = 0;
  double scale = 1;  ///< value = integer * scale + offset
  double offset = 0;
  int bits = 64;  ///< 0: no stream bytes at all, every value is the minimum
};

/// From the coordinates of a scan to those of the file.
struct E57Pose {
  glm::dmat3 rotation{1};
  glm::dvec3 translation{0};

  [[nodiscard]] glm::dvec3 apply(const glm::dvec3& point) const { return rotation * point + translation; }
};

/// A scan of the file.
struct E57Scan {
  std::string name;
  uint64_t section = 0;  ///< physical offset of its compressed vector
  uint64_t count = 0;
  std::vector<E57Field> fields;
  std::optional<E57Pose> pose;
  std::pair<double, double> color_limits{0, 255};  ///< black and full, of all channels

  [[nodiscard]] std::optional<size_t> field(std::string_view name) const;
};

struct E57Header {
  std::vector<E57Scan> scans;
  std::string crs;    ///< coordinate metadata: WKT or free text
  size_t images = 0;  ///< pictures, which are not read
};

/// Parses the XML section. Names and numbers are checked; whether the points are there is not.
Result<E57Header> parse_e57_header(const E57Pages& pages);

}  // namespace surfcast::scan
