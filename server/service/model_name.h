#pragma once

#include <filesystem>
#include <string>

namespace surfcast::service {

/// The name under which a file is served: without its folders and its extension, "brain" for "brain.nii.gz". A file
/// that describes a folder, such as "meta.json" of SOG and "tileset.json" of 3D Tiles, has the name of its folder.
[[nodiscard]] std::string model_name(const std::filesystem::path& path);

/// A name under which there is never a model. Whoever asks for it gets the same answer as for an absent `name`.
[[nodiscard]] std::string hidden_name(const std::string& name);
/// As errors write a name that was asked for: that of hidden_name as it was before.
[[nodiscard]] std::string shown_name(const std::string& name);

}  // namespace surfcast::service
