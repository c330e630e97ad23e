#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "reference/scenes.h"

namespace surfcast::lab {

/// A scene of the laboratory: a scan, a view of it, and what it ought to look like.
struct LabScene {
  std::string name;
  std::string about;  ///< half a sentence for the documentation
  /// A sampled analytic surface, whose ideal picture can be computed; or else
  std::optional<reference::Scene> analytic;
  std::filesystem::path scan;  ///< a scan or a model: its ideal picture is its own, supersampled
};

/// Names of the scenes that come with the program, in the order of the tables.
std::vector<std::string> lab_scene_names();
LabScene make_lab_scene(const std::string& name);
/// A scan or model of the user's.
LabScene scan_scene(const std::filesystem::path& scan);

/// The requests of a slow camera path: the view moves sideways and up by a fraction of a pixel from frame to frame.
std::vector<picture::PictureRequest> slow_path(const picture::PictureRequest& request, int side, int frames);

}  // namespace surfcast::lab
