#pragma once

#include <string>
#include <vector>

#include "geometry/camera.h"
#include "reference/light_picture.h"
#include "reference/transfer_function.h"
#include "reference/volume_field.h"
#include "reference/volume_grid.h"

namespace surfcast::reference {

/// An analytic field, its samples, what it looks like, and a view of it.
struct VolumeScene {
  VolumeField field;
  VolumeGrid grid;
  std::vector<TransferPoint> points;  ///< of the transfer function
  double spacing = 1;                 ///< to which their opacities refer, world units
  TransferFunction transfer;
  bool shaded = false;
  geometry::CameraFrame frame;
};

/// Fields: torus, ball, blobs, ml. Views: mid, low, wide (110 degrees), near, inside, far. `size`: samples along each
/// axis; `side`: of the square picture, pixels. Opacities refer to the spacing of 32 samples (ml: 41) for every size,
/// so that all sizes show the same ideal picture.
VolumeScene make_volume_scene(const std::string& field, const std::string& view, const glm::ivec3& size, int side);
/// A view by name; `closer` divides its distance from the focal point.
geometry::CameraFrame volume_view(const std::string& name, int side, double closer = 1);
/// The points of a transfer function: "smooth", "edge", "faint", "soft" (those of the fields above, in this order) or
/// "shell". The opacity is linear between the values that define them.
std::vector<TransferPoint> transfer_points(const std::string& name);
/// The function of these points. Its opacities are those of the given spacing, world units.
TransferFunction transfer_by_name(const std::string& name, double spacing);

/// The analytic field, integrated finely along 3 x 3 rays a pixel and filtered with the pixel prefilter.
LightPicture ideal_picture(const VolumeScene& scene);

}  // namespace surfcast::reference
