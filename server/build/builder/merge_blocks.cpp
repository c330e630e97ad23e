#include "builder/merge_blocks.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "builder/step_content.h"
#include "ldc/subtree.h"
#include "model/write_blocks.h"

namespace surfcast::builder {
namespace {

/// Adds the blocks of all parts to a model, and then the levels above.
class PartMerger {
 public:
  PartMerger(const WorkFolder& folder, model::ModelWriter& writer) : folder_(folder), writer_(writer) {}

  Status add_part(size_t part) {
    const Result<WorkFile> file = folder_.result(WorkStep::kBlocks, part);
    if (!file) return fail(file);
    Result<StoredPart> stored = read_part_blocks(*file);
    if (!stored) return fail(stored);
    for (size_t i = 0; i < stored->blocks.size(); ++i) {
      if (Status status = add_block(*file, i, stored->blocks[i]); !status) return status;
    }
    writer_.add_statistics(stored->statistics);
    for (ldc::FrontCell& cell : stored->front) {
      for (uint32_t& block : cell.blocks) block += first_;
      front_.push_back(std::move(cell));
    }
    first_ += static_cast<uint32_t>(stored->blocks.size());
    return {};
  }

  Status add_levels_above(const geometry::RootCube& root, const surfel::SurfelCloud& common) {
    const std::vector<ldc::TreeBlock> blocks =
        ldc::build_levels_above(std::move(front_), root, ldc::coarse_attributes(common), first_);
    return model::write_blocks(writer_, common, blocks, {});
  }

 private:
  Status add_block(const WorkFile& file, size_t number, StoredPartBlock& stored) {
    Result<std::vector<std::byte>> bytes = file.read(number);
    if (!bytes) return fail(bytes);
    stored.block.bytes = std::move(*bytes);
    for (uint32_t& child : stored.children) child += first_;
    const Result<uint32_t> added = writer_.add(stored.block, stored.key, stored.children);
    if (!added) return fail(added);
    stored = {};
    return {};
  }

  const WorkFolder& folder_;
  model::ModelWriter& writer_;
  uint32_t first_ = 0;  ///< number of the first block of the part
  ldc::Front front_;
};

}  // namespace

Status merge_blocks(const WorkFolder& folder, const geometry::RootCube& root, const surfel::SurfelCloud& common,
                    StageClock& clock, model::ModelWriter& writer) {
  PartMerger merger(folder, writer);
  clock.begin("writing blocks", folder.parts());
  for (size_t part = 0; part < folder.parts(); ++part) {
    if (Status status = merger.add_part(part); !status) return status;
    clock.step();
  }
  clock.begin("writing levels above", 1);
  return merger.add_levels_above(root, common);
}

}  // namespace surfcast::builder
