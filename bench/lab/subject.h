#pragma once

#include <filesystem>
#include <memory>

#include "lab/methods.h"
#include "lab/scan_points.h"
#include "lab/scenes.h"

namespace surfcast::lab {

/// A scene prepared for measurement: its model and its ideal pictures.
struct Subject {
  std::string name;
  std::string about;
  std::shared_ptr<const model::ModelFile> model;
  picture::PictureRequest request;
  SrgbPicture ideal;
  std::vector<picture::PictureRequest> path;
  std::vector<SrgbPicture> ideal_path;
};

/// Builds the scene's model from a scan with the builder, in `folder`, opens it with the methods, and computes its
/// ideal pictures. `path_frames` is the length of the slow camera path.
Subject prepare(const LabScene& scene, const std::filesystem::path& folder, int path_frames, Methods& methods);

/// Builds a model of a scan with the builder, in `folder`, and opens it. `z_up`: the vertical axis; none: as the scan's
/// format or points suggest.
std::shared_ptr<const model::ModelFile> built_model(const std::filesystem::path& scan,
                                                    const std::filesystem::path& folder, std::optional<bool> z_up);

/// The points of a scan, coloured if they have no colours.
LabPoints colored_points(const std::filesystem::path& scan);

void write_or_exit(const LabPoints& points, const std::filesystem::path& path);

}  // namespace surfcast::lab
