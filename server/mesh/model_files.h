#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "mesh/mesh.h"

namespace surfcast::mesh {

/// A file that a model names: relative to the model, in its folder or below. `\` separates folders too, and %20 and the
/// like stand for bytes if there is no file of that very name. None for names that leave the folder, by links too, and
/// for addresses.
[[nodiscard]] std::optional<std::filesystem::path> named_file(const std::filesystem::path& model,
                                                              std::string_view name);

/// The image of that name, or why there is none.
[[nodiscard]] ImageSource named_image(const std::filesystem::path& model, const std::string& name);

/// `text` with %XX replaced by bytes.
[[nodiscard]] std::string decode_percent(std::string_view text);

}  // namespace surfcast::mesh
