#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "geometry/box.h"
#include "scan/json_access.h"
#include "scan/selection.h"

namespace surfcast::scan {

/// A node of a Potree octree. Its name is `r` and a digit per level: bit 2 is x, bit 1 y, bit 0 z.
struct PotreeNode {
  std::string name;
  uint64_t points = 0;
  uint64_t offset = 0;  ///< version 2: of its points in octree.bin
  uint64_t bytes = 0;   ///< version 2
};

/// The cube of a node, by halving that of the root.
geometry::Box potree_cube(const geometry::Box& root, const std::string& name);

/// Nodes with points, those with bounds only where they may have points of the selection, by the length of their names,
/// then by name. `description`: cloud.js or metadata.json, in `folder`.
Result<std::vector<PotreeNode>> potree1_nodes(const std::filesystem::path& folder, const Json& description,
                                              const geometry::Box& cube, const Selection& selection);
Result<std::vector<PotreeNode>> potree2_nodes(const std::filesystem::path& folder, const Json& description,
                                              const geometry::Box& cube, const Selection& selection);

/// The file of a node of version 1, or of the hierarchy below it, in the folder of nodes: r/, then folders of `step`
/// digits each.
std::string potree1_file(const std::string& node, uint64_t step, const char* extension);

}  // namespace surfcast::scan
