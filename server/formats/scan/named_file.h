#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace surfcast::scan {

/// A file that a model names: relative to the model, in its folder or below. `\` separates folders too, and %20 and the
/// like stand for bytes if there is no file of that very name. None for names that leave the folder, by links too, and
/// for addresses.
[[nodiscard]] std::optional<std::filesystem::path> named_file(const std::filesystem::path& model,
                                                              std::string_view name);

}  // namespace surfcast::scan
