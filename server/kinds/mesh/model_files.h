#pragma once

#include <filesystem>
#include <string>

#include "mesh/mesh.h"
#include "scan/named_file.h"

namespace surfcast::mesh {

using scan::named_file;

/// The image of that name, or why there is none.
[[nodiscard]] ImageSource named_image(const std::filesystem::path& model, const std::string& name);

}  // namespace surfcast::mesh
