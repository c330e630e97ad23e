#pragma once

#include <filesystem>
#include <string>

namespace surfcast::service {

/// The name under which a file is served: without its folders and its extension, "brain" for "brain.nii.gz". A file
/// that describes a folder, such as "meta.json" of SOG and "tileset.json" of 3D Tiles, has the name of its folder.
[[nodiscard]] std::string model_name(const std::filesystem::path& path);

}  // namespace surfcast::service
