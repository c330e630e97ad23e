#include "kinds/file_blocks.h"

#include "base/contract.h"

namespace surfcast::kinds {

FileBlocks::FileBlocks(std::shared_ptr<const model::ModelFile> model, KindTable kinds, std::vector<uint32_t> numbers)
    : model_(std::move(model)), kinds_(kinds), numbers_(std::move(numbers)) {
  std::vector<ldc::BlockEntry> blocks(model_->blocks().begin(), model_->blocks().end());
  bool differs = false;
  for (uint32_t block = 0; block < blocks.size(); ++block) {
    const uint64_t texels = kinds_[kind_of(block)]->texels(model_->info(), blocks[block].items);
    const uint64_t items = (texels + residency::kMaxPackedPerSurfel - 1) / residency::kMaxPackedPerSurfel;
    differs |= items != blocks[block].items;
    blocks[block].items = static_cast<uint32_t>(items);
  }
  if (differs) tree_.emplace(std::move(blocks));
}

Result<residency::PackedBlock> FileBlocks::load(uint32_t block, bool attributes) const {
  Result<residency::PackedBlock> packed = kinds_[kind_of(block)]->load(*model_, block, attributes);
  // Selection and residency rely on this limit.
  SURFCAST_EXPECTS(!packed ||
                   packed->texels.size() <= size_t{residency::kMaxPackedPerSurfel} * tree().blocks()[block].items);
  return packed;
}

}  // namespace surfcast::kinds
