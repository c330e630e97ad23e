#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "builder/make_part.h"
#include "builder/part_store.h"
#include "ldc/subtree.h"
#include "model/model_file.h"
#include "model/statistics.h"
#include "scan/scan_points.h"
#include "scan/scan_schema.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::builder {

// The points that a model has before others are added to it.

/// What a model tells of its points that its tables do not.
struct FormerModel {
  bool stated_normals = false;  ///< normals come from a source: they are not estimated again
  bool stated_radii = false;
  std::vector<InputName> lattices;  ///< on which positions lie; without a grid: those that follow from radii
};

/// Reads it from the first bytes of the leaves in `leaves`.
Result<FormerModel> former_model(const model::ModelFile& model, std::span<const uint32_t> leaves);

/// The schema of a model's points as they would be read from a scan.
scan::ScanSchema schema_of_points(const model::ModelFile& model);

/// Adds two attributes that carry radii and scatter of former points through the stages of a build.
void add_former_columns(scan::ScanSchema& schema);
/// Gives former points of a part what they had, and removes the two attributes.
void restore_former(surfel::SurfelCloud& cloud);

/// The points of a decoded leaf under a schema with these columns. Of those for which `is_affected` is true, normals
/// and radii are left to be estimated, unless a source states them.
scan::ScanPoints points_of_leaf(model::DecodedBlock block, int color_bits, const FormerModel& former,
                                const scan::ScanSchema& schema,
                                const std::function<bool(const glm::dvec3& position, float radius)>& is_affected);

/// The index of the lattice of a block.
size_t lattice_of(const surfel::Grid& grid, const FormerModel& former);

/// The cells in which a block stays that is copied, for the levels above. `key`: its cell; `parent`: that of its
/// parent; none of the root.
std::vector<ldc::FrontCell> front_of_kept(model::DecodedBlock block, const model::ModelFile& model, bool leaf,
                                          const ldc::OctreeKey& key, const std::optional<ldc::OctreeKey>& parent,
                                          const geometry::RootCube& root, uint32_t number);

/// The statistics of the surfels of a decoded block.
model::AttributeStatistics statistics_of(model::DecodedBlock block, const model::ModelInfo& info);

}  // namespace surfcast::builder
