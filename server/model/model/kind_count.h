#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace surfcast::model {

/// The kind of the blocks of scans, and the only kind in files of version 2.
inline constexpr std::string_view kSurfelKind = "surfel";

/// Blocks of one kind in a model.
struct KindCount {
  std::string kind;     ///< its name
  uint32_t blocks = 0;  ///< of all levels
  uint64_t items = 0;   ///< surfels, or items of another kind, in the leaves of the tree
};

}  // namespace surfcast::model
