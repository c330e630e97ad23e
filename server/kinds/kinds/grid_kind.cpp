#include <utility>

#include "kinds/brick_block.h"
#include "kinds/built_in_kinds.h"
#include "kinds/grid_block.h"
#include "volume/packing.h"
#include "volume/read_brick.h"

namespace surfcast::kinds {

Result<residency::PackedBlock> GridKind::load(const model::ModelFile& model, uint32_t block, bool attributes) const {
  const Result<volume::Brick> brick = volume::read_brick(model, block);
  if (!brick) return fail(brick);
  const Result<model::StoredBlock> stored = model.stored(block);
  if (!stored) return fail(stored);
  residency::PackedBlock packed;
  packed.lattice = {stored->grid, stored->origin, glm::ivec3(0), stored->extent};
  packed.texels = volume::pack_brick(*brick);
  if (attributes) packed.attributes.resize(packed.texels.size());
  const model::Volume& volume = model.volumes()[brick->header.volume];
  packed.header = std::make_shared<const BrickBlock>(*brick, volume.size, volume.index_to_world);
  return packed;
}

uint64_t GridKind::texels(const model::ModelInfo& info, uint32_t items) const {
  const uint32_t texels = volume::most_texels(items);
  return texels > 0 ? texels : Kind::texels(info, items);  // of a damaged block, which is not loaded
}

Result<std::shared_ptr<const SourceBlock>> GridKind::decode(const model::ModelFile& model, uint32_t block) const {
  Result<volume::Brick> brick = volume::read_brick(model, block);
  if (!brick) return fail(brick);
  const model::Volume& volume = model.volumes()[brick->header.volume];
  return std::make_shared<const GridBlock>(std::move(*brick), volume);
}

}  // namespace surfcast::kinds
