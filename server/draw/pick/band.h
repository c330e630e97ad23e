#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "model/model_file.h"
#include "surfel/grid.h"

namespace surfcast::pick {

/// A place relative to the course of a line, world units.
struct CoursePlace {
  double along = 0;   ///< distance along the course, of its nearest point
  double across = 0;  ///< distance from the course; positive on its left, seen from above
};

/// The course of a line on the horizontal plane: its projection along the vertical axis.
class Course {
 public:
  /// Fails unless the line has two points of different courses.
  static Result<Course> of(const std::vector<glm::dvec3>& line, bool z_up);

  [[nodiscard]] double length() const { return length_; }
  /// The place of a point whose nearest point of the course is at most `reach` away. None for others, and for points
  /// beyond the ends of the course, so that a band is cut off straight there.
  [[nodiscard]] std::optional<CoursePlace> place(const glm::dvec3& point, double reach) const;
  /// False only if no point of the box has a place.
  [[nodiscard]] bool may_reach(const geometry::Box& box, double reach) const;

 private:
  struct Part {
    glm::dvec2 from{0};
    glm::dvec2 direction{0};  ///< unit
    double length = 0;
    double before = 0;  ///< length of the course up to here
  };

  [[nodiscard]] glm::dvec2 level(const glm::dvec3& point) const;

  std::vector<Part> parts_;
  double length_ = 0;
  bool z_up_ = true;
};

/// A band along a line. It has no limits in height.
struct BandQuery {
  std::vector<glm::dvec3> line;  ///< world
  double width = 0;              ///< horizontal, world units
  size_t most = 0;               ///< points to return
};

struct BandPoint {
  glm::dvec3 position{0};  ///< world; exact for inputs whose coordinates lie on a grid
  CoursePlace place;
  glm::u16vec3 color{0};  ///< in ModelInfo::color_bits
};

/// The surfels of the finest level in a band, in ascending order of `along`.
struct Band {
  uint64_t total = 0;   ///< surfels in the band
  double length = 0;    ///< of the course
  surfel::Grid grid{};  ///< the finest lattice of the points; they all lie on it where it is that of the scan
  std::vector<BandPoint> points;
  std::vector<double> values;  ///< of ModelInfo::scalar_names, all values of a point together
};

/// Finds the surfels in a band. If there are more than `most`, the result is an even sample of them, the same at every
/// call. Reads the leaves that the band touches. Fails on an invalid line, if one of the leaves is damaged, and with
/// kCancelled soon after `cancelled` becomes true.
Result<Band> find_band(const model::ModelFile& model, const BandQuery& query, const std::atomic<bool>& cancelled);

}  // namespace surfcast::pick
