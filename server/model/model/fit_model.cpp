#include "model/fit_model.h"

#include <algorithm>
#include <vector>

#include "geometry/fit_camera.h"

namespace surfcast::model {
namespace {

constexpr double kViewAngle = 30;  // degrees, of the default camera

/// Sums of normals and of their weights.
struct Facing {
  glm::dvec3 normals{0};
  double weight = 0;
  [[nodiscard]] glm::dvec3 mean() const { return weight > 0 ? normals / weight : glm::dvec3(0); }
};

/// From the cones of the leaves.
Facing facing_of_leaves(const ModelFile& model) {
  Facing facing;
  for (const ldc::BlockEntry& block : model.blocks()) {
    if (block.level > 0) continue;
    const auto weight = static_cast<double>(block.items);
    facing.weight += weight;
    if (block.normals) facing.normals += glm::dvec3(block.normals->axis) * weight;
  }
  return facing;
}

/// From the discs of the coarsest blocks, by area: a block with scatter has no cone.
Facing facing_of_discs(const ModelFile& model) {
  Facing facing;
  for (size_t i = 0; i < model.blocks().size(); ++i) {
    if (model.blocks()[i].parent != ldc::BlockEntry::kNoParent) continue;
    const Result<DecodedBlock> block = model.decode(i, WantedScalars::kNone);
    for (size_t k = 0; block && k < block->size(); ++k) {
      if (block->is_scatter(k)) continue;
      const double area = double{block->radii[k]} * double{block->radii[k]};
      facing.weight += area;
      facing.normals += area * glm::dvec3(block->normals[k]);
    }
  }
  return facing;
}

/// Mean normal of the whole model; zero if the model is not oriented.
glm::dvec3 mean_facing(const ModelFile& model) {
  if (model.info().scatter == 0) return facing_of_leaves(model).mean();
  return model.info().oriented ? facing_of_discs(model).mean() : glm::dvec3(0);
}

/// Where the surfels of the coarsest blocks are: cells, as the boxes of blocks in place are, say little of a surface.
std::vector<geometry::Box> boxes_of_coarsest(const ModelFile& model) {
  std::vector<geometry::Box> boxes;
  for (size_t i = 0; i < model.blocks().size(); ++i) {
    if (model.blocks()[i].parent != ldc::BlockEntry::kNoParent) continue;
    const Result<DecodedBlock> block = model.decode(i, WantedScalars::kNone);
    for (size_t k = 0; block && k < block->size(); ++k) {
      const glm::dvec3 at = block->position(k);
      boxes.push_back({at - double{block->radii[k]}, at + double{block->radii[k]}});
    }
  }
  return boxes;
}

/// The bounding boxes of all leaves, including their discs. Together they follow the surface more closely than the
/// model's own box, whose corners are mostly empty.
std::vector<geometry::Box> boxes_of_discs(const ModelFile& model) {
  std::vector<geometry::Box> boxes;
  const auto placed = [](const Member& member) { return !member.places.empty(); };
  if (model.info().in_place && std::ranges::none_of(model.members(), placed)) {
    for (const Member& member : model.members()) {
      const std::vector<geometry::Box> own = boxes_of_discs(*member.model);
      boxes.insert(boxes.end(), own.begin(), own.end());
    }
    if (model.members().empty()) boxes = boxes_of_coarsest(model);
    if (!boxes.empty()) return boxes;
  }
  for (const ldc::BlockEntry& block : model.blocks()) {
    if (block.level > 0) continue;
    // The largest of other kinds may be far larger than what is seen of them.
    const bool discs = model.info().kinds[block.kind].kind == kSurfelKind;
    const double reach = discs ? block.max_radius : block.spacing;
    boxes.push_back({block.bounds.min - reach, block.bounds.max + reach});
  }
  return boxes;
}

}  // namespace

geometry::Camera fit_model(const ModelFile& model, double aspect) {
  return geometry::fit_camera(boxes_of_discs(model), model.info().up(), aspect, kViewAngle, mean_facing(model));
}

}  // namespace surfcast::model
