#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/result.h"
#include "crs/coordinate_system.h"

namespace surfcast::crs {

struct Operation;

/// Brings positions from one system into another by one operation of PROJ, the best one for a box that needs no grid
/// which is not installed. All methods are const and may be called from several threads at once.
///
/// Heights: if both systems state what they are, or one of them is geocentric or geographic in three dimensions, they
/// are transformed, too. Otherwise they stay what they are and only change their unit.
class Transformation {
 public:
  /// `bounds`: of the positions, in `from`. An error in one line if PROJ knows no operation, or none that the middle of
  /// the box survives.
  static Result<Transformation> between(const CoordinateSystem& from, const CoordinateSystem& to,
                                        const geometry::Box& bounds);

  Transformation(Transformation&&) noexcept;
  Transformation& operator=(Transformation&&) noexcept;
  ~Transformation();

  [[nodiscard]] const std::string& name() const;         ///< of the operation, as PROJ calls it
  [[nodiscard]] std::optional<double> accuracy() const;  ///< metres; none: unknown
  [[nodiscard]] double length_factor() const;            ///< a length in `to` of a length of 1 in `from`
  /// Turns directions as at the middle of the box: 0.01 degrees wrong at a kilometre from there at most. Directions in
  /// geographic systems are those of east, north and up.
  [[nodiscard]] const glm::dmat3& turn() const;
  /// A position that cannot be transformed becomes NaN.
  void apply(std::span<glm::dvec3> positions) const;

 private:
  explicit Transformation(std::unique_ptr<Operation> operation);
  std::unique_ptr<Operation> operation_;
};

}  // namespace surfcast::crs
