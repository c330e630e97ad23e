#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/model_file.h"
#include "picture/picture.h"
#include "reference/gaussian_model.h"
#include "reference/volume_scenes.h"

namespace surfcast::lab {

using ModelPointer = std::shared_ptr<const model::ModelFile>;
using reference::LightPicture;

/// A volume, prepared for measurement.
struct VolumeSubject {
  std::string name;
  std::string about;
  ModelPointer model;
  picture::PictureRequest request;
  reference::VolumeGrid grid;
  reference::TransferFunction transfer;
  geometry::CameraFrame frame;
  std::optional<LightPicture> ideal{};  ///< of an analytic field
};

/// Analytic fields, seen from all the views of the tests, 128 x 128 pixels. `about` names grid and view.
std::vector<VolumeSubject> analytic_volumes(const std::filesystem::path& folder);
/// A volume of a file, as [PRESET:]PATH, seen from where it fits, with the opacities of the preset. Everything is
/// white, so that a picture is the opacity, whatever light a program blends in.
VolumeSubject volume_of_file(const std::string& grid, int side, const std::filesystem::path& folder);

/// Writes NAME.json and the grid (NAME.mhd, NAME.raw) with axes along those of the world, as other programs read it.
void export_volume(const VolumeSubject& subject, const std::filesystem::path& folder);

/// A Gaussian model, prepared for measurement, 64 x 64 pixels.
struct GaussianSubject {
  std::string name;
  std::string about;
  ModelPointer model;
  picture::PictureRequest request;
  reference::GaussianModel splats;
  geometry::CameraFrame frame;
  LightPicture ideal;  ///< sRGB codes
};
std::vector<GaussianSubject> gaussian_subjects(const std::filesystem::path& folder);

/// The view of a frame.
geometry::Camera camera_of(const geometry::CameraFrame& frame);
/// The same view with other numbers of pixels of the same size, or of a part of it.
geometry::CameraFrame with_pixels(geometry::CameraFrame frame, int side, double finer = 1);

}  // namespace surfcast::lab
