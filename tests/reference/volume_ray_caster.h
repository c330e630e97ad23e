#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "geometry/camera.h"
#include "reference/light_picture.h"
#include "reference/transfer_function.h"
#include "reference/volume_grid.h"

namespace surfcast::reference {

/// A part of a ray by the distance from the eye, world units; empty if it ends before it begins.
struct RayInterval {
  double begin = 0;
  double end = 0;
};

/// A box along the axes of the world, world coordinates.
struct ClipBox {
  glm::dvec3 low;
  glm::dvec3 high;
};

/// The part of a ray from the eye on, with a unit direction, within the faces of a grid and the clip box.
RayInterval visible_interval(const VolumeGrid& grid, const std::optional<ClipBox>& clip, const glm::dvec3& eye,
                             const glm::dvec3& direction);

/// An opaque or partly covering surface on a ray.
struct SurfaceLayer {
  double distance = 0;  ///< from the eye, world units
  glm::dvec3 color{0};  ///< linear light
  double coverage = 1;
};
/// The layers of the ray with this unit direction in the world, by distance.
using SurfaceLayers = std::function<std::vector<SurfaceLayer>(const glm::dvec3& direction)>;

/// What is seen at a place in the world.
struct RayMedium {
  std::function<double(const glm::dvec3& place)> scalar;
  std::function<glm::dvec3(const glm::dvec3& place)> gradient;  ///< empty: no shading
};

/// Unit direction in the world of a position of the picture.
glm::dvec3 ray_direction(const geometry::CameraFrame& frame, const glm::dvec2& pixel);

/// Emission and absorption along a ray, in steps of at most `step`, each with the scalar of its middle.
glm::dvec4 cast_ray(const RayMedium& medium, const TransferFunction& transfer, const glm::dvec3& eye,
                    const glm::dvec3& direction, const RayInterval& interval, double step);

enum class Reconstruction { kTrilinear, kCatmullRom };

/// Ray casting of a grid with one ray a pixel and steps of half a spacing. Shaded by the interpolated central
/// differences of the samples.
LightPicture ray_cast(const VolumeGrid& grid, const TransferFunction& transfer, bool shaded,
                      const geometry::CameraFrame& frame, Reconstruction reconstruction);

/// The surface where the field has a value; lit by a headlight.
struct ValueSurface {
  double value = 0;
  glm::dvec3 color{1};  ///< linear light
  double opacity = 1;
};

/// A plane through the grid in the colours of the transfer function, without its opacities.
struct SlicePlane {
  glm::dvec3 point{0};  ///< world
  glm::dvec3 normal{0, 0, 1};
  double opacity = 1;
};

/// How a grid is drawn by cubic rays. The defaults are the method; the rest is for studies.
struct CubicRayParameters {
  double step = 1;      ///< between places on the ray, in spacings of the samples along it
  int parts = 3;        ///< of a segment between two places; over each the transfer function is integrated on its own
  double clear = 1e-3;  ///< transmittance at which a ray ends
  bool filter = true;   ///< the finished light with the pixel prefilter
  bool shaded = false;
  SurfaceLayers layers{};
  std::vector<ClipBox> inside{};   ///< of which one must contain what is seen, if there are any
  std::vector<ClipBox> outside{};  ///< which must not
  std::vector<ValueSurface> isos{};
  std::vector<SlicePlane> slices{};
  bool medium = true;  ///< what the transfer function shows is drawn
};

/// Draws a grid with one ray a pixel. The scalar and its gradient are reconstructed with the kernel of Catmull and Rom
/// at multiples of the step about the volume's centre (about the eye if it is in the volume) and at faces. Between two
/// places the scalar is the cubic with their values and derivatives.
LightPicture cast_cubic_rays(const VolumeGrid& grid, const TransferFunction& transfer,
                             const geometry::CameraFrame& frame, const CubicRayParameters& parameters = {});

}  // namespace surfcast::reference
