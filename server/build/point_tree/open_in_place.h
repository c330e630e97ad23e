#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "base/byte_source.h"
#include "base/file_folder.h"
#include "base/result.h"
#include "model/block_cache.h"
#include "model/model_file.h"

namespace surfcast::point_tree {

/// What trees of points may take.
struct InPlaceLimits {
  uint64_t hierarchy_bytes = uint64_t{64} << 20;  ///< of a hierarchy, which is read whole when its file is opened
  size_t memory = size_t{512} << 20;              ///< for points and blocks of one model
};

/// What an octree of points is stored as.
enum class TreeFormat {
  kCopc,     ///< one file, "x.copc.laz"
  kEpt,      ///< a folder of files that "ept.json" describes
  kPotree2,  ///< the same, "metadata.json"; of this machine only
};

/// The format of what a path or URL (without its query) names; none if it is no octree of points by its name.
std::optional<TreeFormat> tree_format_of(std::string_view path);

/// A model of the points of an octree of points, without a conversion: its blocks are made of the nodes when they are
/// first asked for. `file`: the only one, or the one that describes the others; `folder`: where these are, or null.
/// `cache`: keeps blocks on this disk; may be null. Errors name the file.
Result<model::ModelFile> open_in_place(TreeFormat format, std::unique_ptr<const ByteSource> file,
                                       std::unique_ptr<const FileFolder> folder, const InPlaceLimits& limits,
                                       std::shared_ptr<model::BlockCache> cache);

}  // namespace surfcast::point_tree
