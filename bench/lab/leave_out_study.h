#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lab/leave_out.h"
#include "lab/leave_out_cameras.h"
#include "lab/scan_points.h"
#include "lab/srgb_pictures.h"
#include "model/model_file.h"

namespace surfcast::lab {

/// Colour errors of one kernel or method.
struct KernelColors {
  ColorErrors all;
  ColorErrors near;  ///< of the points whose neighbours are two pixels and more away
};

/// What one camera shows of the points that were left out.
struct CameraResult {
  NamedCamera camera;
  LeaveOutCounts counts;
  std::vector<KernelColors> colors;  ///< one for each picture; empty if the points have no colour
};

struct LeaveOutResult {
  std::string name;
  uint64_t points = 0;  ///< of the scan, at distinct positions
  uint64_t left_out = 0;
  double largest_radius = 0;  ///< of the drawn radii over the spacing of the surfaces around; 0 without surfaces
  std::vector<CameraResult> cameras{};

  [[nodiscard]] LeaveOutCounts total() const;
  [[nodiscard]] std::vector<KernelColors> colors() const;
};

/// Makes the model of the points that were kept.
using MakeModel = std::function<std::shared_ptr<const model::ModelFile>(const LabPoints& kept)>;

/// Draws a picture of the last model that was made, with each of the kernels or methods that are compared.
using DrawPictures = std::function<std::vector<SrgbPicture>(const NamedCamera&, const picture::PictureRequest&)>;

/// Leaves out one point in five, makes a model of the others, and looks for the points that were left out.
LeaveOutResult study_points(const std::string& name, const LabPoints& points, Place place, const MakeModel& make_model,
                            const DrawPictures& draw);

}  // namespace surfcast::lab
