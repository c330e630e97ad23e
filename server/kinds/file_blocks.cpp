#include "kinds/file_blocks.h"

#include "base/contract.h"

namespace surfcast::kinds {

Result<residency::PackedBlock> FileBlocks::load(uint32_t block, bool attributes) const {
  Result<residency::PackedBlock> packed = kinds_[kind_of(block)]->load(*model_, block, attributes);
  // Selection and residency rely on this limit.
  SURFCAST_EXPECTS(!packed ||
                   packed->texels.size() <= size_t{residency::kMaxPackedPerSurfel} * tree().blocks()[block].surfels);
  return packed;
}

}  // namespace surfcast::kinds
