#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "builder/append_steps.h"
#include "builder/ordered_work.h"
#include "builder/part_blocks.h"
#include "ldc/subtree.h"
#include "model/write_blocks.h"

namespace surfcast::builder {
namespace {

/// Writes the grown model.
class AppendPass {
 public:
  AppendPass(const AppendInputs& inputs, const AppendPlan& plan, model::ModelWriter& writer)
      : inputs_(inputs), plan_(plan), writer_(writer) {}

  Status copy_kept(StageClock& clock) {
    clock.begin("copying blocks", plan_.kept.size());
    for (const uint32_t block : plan_.kept) {
      const Result<uint32_t> number = copy(block);
      if (!number) return fail(number);
      Result<model::DecodedBlock> decoded = inputs_.model.decode(block);
      if (!decoded) return fail(decoded);
      const uint32_t parent = inputs_.model.blocks()[block].parent;
      std::optional<ldc::OctreeKey> parent_key;
      if (parent != ldc::BlockEntry::kNoParent) parent_key = key_of(parent);
      for (ldc::FrontCell& cell : front_of_kept(std::move(*decoded), inputs_.model, is_leaf(inputs_.model, block),
                                                key_of(block), parent_key, inputs_.root.root, *number)) {
        front_.push_back(std::move(cell));
      }
      clock.step();
    }
    return {};
  }

  Status write_regions(BuildParts& parts, const MemoryPlan& memory, const AppendOptions& options, StageClock& clock) {
    clock.begin("writing blocks", parts.size());
    const bool new_normals = inputs_.added.schema().normals || inputs_.former.stated_normals;
    return work_in_order(
        parts.size(), parts.parts_at_once(memory), [&](size_t part) -> Result<std::function<Status()>> {
          Result<FinishedPart> surfels = parts.take(part);
          if (!surfels) return fail(surfels);
          restore_former(surfels->cloud);
          surfels->cloud.estimated_normals = !new_normals;
          surfels->cloud.estimated_radii = surfels->cloud.estimated_radii && !inputs_.former.stated_radii;
          auto blocks = std::make_shared<PartBlocks>(
              make_part_blocks(std::move(*surfels), parts.plan(part), parts.root(), options.precision));
          return [this, &clock, blocks] {
            clock.step();
            return write(*blocks);
          };
        });
  }

  Status write_levels_above(const surfel::SurfelCloud& common) {
    const std::vector<ldc::TreeBlock> blocks = ldc::build_levels_above(
        std::move(front_), inputs_.root.root, ldc::coarse_attributes(common), static_cast<uint32_t>(blocks_));
    return model::write_blocks(writer_, common, blocks, {});
  }

  [[nodiscard]] uint64_t copied() const { return copied_; }

 private:
  [[nodiscard]] ldc::OctreeKey key_of(uint32_t block) const {
    return inputs_.root.key_of(inputs_.model.blocks()[block].key);
  }

  /// Copies a block after those below it.
  Result<uint32_t> copy(uint32_t block) {
    std::vector<uint32_t> children;
    const auto [first, count] = inputs_.model.tree().children(block);
    for (uint32_t child = first; child < first + count; ++child) {
      Result<uint32_t> number = copy(child);
      if (!number) return number;
      children.push_back(*number);
    }
    const Result<model::StoredBlock> stored = inputs_.model.stored(block);
    if (!stored) return fail(stored);
    const ldc::BlockEntry& entry = inputs_.model.blocks()[block];
    model::EncodedBlock same;
    same.bytes.assign(stored->bytes.begin(), stored->bytes.end());
    same.grid = stored->grid;
    same.origin = stored->origin;
    same.extent = stored->extent;
    same.items = stored->items;
    same.scatter = stored->scatter;
    same.spacing = static_cast<float>(entry.spacing);
    same.max_radius = static_cast<float>(entry.max_radius);
    same.normals = entry.normals;
    ++blocks_;
    ++copied_;
    return writer_.add(same, key_of(block), children);
  }

  Status write(PartBlocks& part) {
    renumber(static_cast<uint32_t>(blocks_), part.subtree);
    blocks_ += part.subtree.blocks.size();
    for (ldc::FrontCell& cell : part.subtree.front) front_.push_back(std::move(cell));
    return model::write_blocks(writer_, part.cloud, part.subtree.blocks, {});
  }

  const AppendInputs& inputs_;
  const AppendPlan& plan_;
  model::ModelWriter& writer_;
  size_t blocks_ = 0;
  uint64_t copied_ = 0;
  ldc::Front front_;
};

}  // namespace

Result<uint64_t> write_grown_blocks(const AppendInputs& inputs, const AppendPlan& plan, BuildParts& parts,
                                    const MemoryPlan& memory, const AppendOptions& options,
                                    const surfel::SurfelCloud& common, StageClock& clock, model::ModelWriter& writer) {
  AppendPass pass(inputs, plan, writer);
  Status status = pass.copy_kept(clock);
  if (status) status = pass.write_regions(parts, memory, options, clock);
  clock.begin("writing levels above", 1);
  if (status) status = pass.write_levels_above(common);
  if (!status) return fail(status);
  return pass.copied();
}

}  // namespace surfcast::builder
