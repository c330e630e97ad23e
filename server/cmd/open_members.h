#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "cmd/in_place_flags.h"
#include "model/model_file.h"
#include "object_store/object_store.h"

namespace surfcast::cmd {

/// Each of the paths, or those that it joins, as "a.surf+b.surf", if there is no file of its name. URLs have plus signs
/// of their own.
[[nodiscard]] std::vector<std::filesystem::path> members_of_paths(std::span<const std::filesystem::path> paths);

/// Gives models that are to be joined names that differ and have no plus sign.
void set_apart(std::vector<std::string>& names);

/// Opens a model file, a model in a store, or a scan in place. Nothing is built.
Result<model::ModelFile> open_model(const std::filesystem::path& path, const object_store::ObjectStore& store,
                                    const InPlaceOpener& in_place);

/// Opens models that are to be joined, which are not placed yet. Fails if one does not open.
Result<std::vector<model::Member>> open_members(std::span<const std::filesystem::path> paths,
                                                const object_store::ObjectStore& store, const InPlaceOpener& in_place);

}  // namespace surfcast::cmd
