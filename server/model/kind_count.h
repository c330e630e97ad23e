#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace surfcast::model {

/// The kind of the blocks that scans are made of, and the only one of files of version 2.
inline constexpr std::string_view kSurfelKind = "surfel";

/// Blocks of one kind in a model.
struct KindCount {
  std::string kind;     ///< its name
  uint32_t blocks = 0;  ///< of all levels
  uint64_t items = 0;   ///< surfels, or what else the kind is made of, of the source: those of the leaves of the tree
};

}  // namespace surfcast::model
