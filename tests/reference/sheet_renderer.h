#pragma once

#include "geometry/camera.h"
#include "reference/light_picture.h"
#include "reference/transfer_function.h"
#include "reference/volume_grid.h"

namespace surfcast::reference {

/// Kernels of Zwicker 2002, section 7.1, for comparisons.
struct SheetParameters {
  double sigma = 1;      ///< standard deviation of kernels, grid spacings
  double cutoff = 4;     ///< largest r2 of a fragment
  double prefilter = 1;  ///< standard deviation, pixels
};

/// Draws a grid as Zwicker does: samples are classified first, projected with the affine form, and summed into the
/// sheets of the grid that are most parallel to the picture. Sheets are composited front to back.
LightPicture draw_sheets(const VolumeGrid& samples, const TransferFunction& transfer,
                         const geometry::CameraFrame& frame, const SheetParameters& parameters = {});

}  // namespace surfcast::reference
