#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string_view>

#include "surfel/surfel_cloud.h"

namespace surfcast::surfel {

/// Orthonormal axes of the plane across a unit normal; (u, v, normal) is right-handed.
struct TangentFrame {
  glm::dvec3 u{1, 0, 0};
  glm::dvec3 v{0, 1, 0};
};

/// A function of the normal alone, continuous except where normal.z = -1e-4. No stored normal is that close to the
/// equator, so that rounding never decides between the two sides (Duff 2017, "Building an Orthonormal Basis,
/// Revisited"). GLSL counterpart: shaders/curved/surface.glsl.
TangentFrame tangent_frame(const glm::dvec3& normal);

/// How a surface bends about a point: in tangent_frame(normal) it is (uu u^2 + 2 uv u v + vv v^2) / 2 below the tangent
/// plane. A sphere of radius R seen from outside has uu = vv = 1 / R. A matrix instead of principal directions, because
/// these are undefined where both curvatures are equal.
struct Curvature {
  double uu = 0;
  double uv = 0;
  double vv = 0;

  /// The larger magnitude of the two principal curvatures.
  [[nodiscard]] double largest() const;
  /// The matrix times a tangent vector.
  [[nodiscard]] glm::dvec2 times(const glm::dvec2& q) const { return {uu * q.x + uv * q.y, uv * q.x + vv * q.y}; }
};

/// The osculating surface of a surfel, in any frame of coordinates (Kalaiah and Varshney 2001, section 3).
struct OsculatingSurface {
  glm::dvec3 centre{0};
  glm::dvec3 normal{0, 0, 1};  ///< unit
  TangentFrame frame;
  Curvature curvature;

  /// Signed distance along the normal of a point from the surface at the point's place in the tangent plane.
  [[nodiscard]] double height(const glm::dvec3& point) const;
  /// The place of a point in the tangent plane.
  [[nodiscard]] glm::dvec2 place(const glm::dvec3& point) const;
  /// Unit. Exact on spheres and cylinders: its part in the tangent plane grows linearly with the place.
  [[nodiscard]] glm::dvec3 normal_at(const glm::dvec2& place) const;
};

/// The surface with a normal whose tangent frame does not change when the normal is rounded to the codes of a model
/// file: normals close to the equator, where the frame switches, are moved onto it, by less than half of a code's step.
OsculatingSurface storable(const OsculatingSurface& surface);

/// The edge of a surface within reach of a surfel: nothing is drawn beyond the line across the tangent plane where
/// place . direction is `distance`.
struct Border {
  glm::dvec2 direction{1, 0};  ///< unit, outwards
  double distance = 1;         ///< in radii of the surfel, > 0
};

/// A ray that meets the surface.
struct SurfaceHit {
  double t = 0;  ///< along the ray, in units of its direction
  glm::dvec2 place{0};
  glm::dvec3 normal{0};  ///< unit
};

/// Where the ray `t * ray`, t > 0, enters the surface. A surface without a front and a back (`oriented` false) is
/// entered from either side, at the meeting nearer to the centre.
std::optional<SurfaceHit> meet(const OsculatingSurface& surface, const glm::dvec3& ray, bool oriented);

/// Curvatures are stored relative to the radius of the surfel, as scalar attributes of these names: steps of
/// 1 / kCurvatureSteps, from -1 to 1. A border is 0 for none, or its angle in 256 steps of a turn, plus 256 times its
/// distance in steps of 1 / kBorderSteps of the radius, from 1 to 127.
inline constexpr std::array<std::string_view, 4> kCurvatureColumns{"surfel_curvature_uu", "surfel_curvature_uv",
                                                                   "surfel_curvature_vv", "surfel_border"};
inline constexpr int kCurvatureSteps = 511;
inline constexpr int kBorderSteps = 120;
using CurvatureCode = std::array<int16_t, 4>;

/// Without a border.
CurvatureCode encode_curvature(const Curvature& curvature, double radius);
int16_t encode_border(const Border& border);
std::optional<Border> decode_border(int16_t code);
Curvature decode_curvature(const CurvatureCode& code, double radius);

/// The codes of the surfels; empty unless the attributes have all columns, of 16 bits.
class CurvatureColumns {
 public:
  explicit CurvatureColumns(const std::vector<ScalarAttribute>& scalars);
  [[nodiscard]] bool empty() const { return columns_[0] == nullptr; }
  /// In range, whatever is stored.
  [[nodiscard]] CurvatureCode at(size_t i) const;

 private:
  std::array<const std::vector<int16_t>*, kCurvatureColumns.size()> columns_{};
};

/// Puts the curvatures of the surfels before all other attributes. One code for each surfel.
void add_curvature(const std::vector<CurvatureCode>& codes, SurfelCloud& cloud);

bool is_curvature_column(std::string_view name);

/// True if the names are those of the attributes of surfels with curvature.
template <typename Names>
bool has_curvature(const Names& names) {
  size_t found = 0;
  for (const auto& name : names) found += is_curvature_column(name) ? 1 : 0;
  return found == kCurvatureColumns.size();
}

}  // namespace surfcast::surfel
