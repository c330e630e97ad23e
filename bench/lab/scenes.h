#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lab/leave_out_cameras.h"
#include "reference/scenes.h"

namespace surfcast::lab {

/// A scene of the laboratory: a scan, a view of it, and the source of its ideal picture.
struct LabScene {
  std::string name;
  std::string about;  ///< short description for the documentation
  /// A sampled analytic surface, whose ideal picture can be computed. If absent, `scan` is used.
  std::optional<reference::Scene> analytic;
  std::filesystem::path scan;    ///< a scan or a model; its ideal picture is its supersampled picture
  std::optional<Place> place{};  ///< of a scan: how it is looked at when points are left out; none: they are not
};

/// Names of the built-in scenes, in the order of the tables.
std::vector<std::string> lab_scene_names();
LabScene make_lab_scene(const std::string& name);
/// The scene of a scan or model given by the user.
LabScene scan_scene(const PlacedScan& scan);

/// The requests of a slow camera path: the view moves sideways and up by a fraction of a pixel from frame to frame.
std::vector<picture::PictureRequest> slow_path(const picture::PictureRequest& request, int side, int frames);

}  // namespace surfcast::lab
