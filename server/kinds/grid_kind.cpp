#include "kinds/grid_kind.h"

#include <utility>

#include "base/contract.h"
#include "kinds/brick_block.h"
#include "volume/packing.h"
#include "volume/read_brick.h"

namespace surfcast::kinds {
namespace {

/// A decoded brick. It has no items that a pixel could show alone.
class GridBlock : public SourceBlock {
 public:
  explicit GridBlock(volume::Brick brick) : brick_(std::move(brick)) {}

  [[nodiscard]] size_t bytes() const override { return brick_.codes.size() * sizeof(uint16_t); }
  void hit(const PickQuery& /*query*/, std::vector<PickHit>& /*hits*/) const override {}
  void cover(const PickQuery& /*query*/, PixelHits& /*pixels*/) const override {}
  [[nodiscard]] PickedSurfel describe(const PickQuery& /*query*/, uint32_t /*item*/) const override {
    SURFCAST_EXPECTS(false);  // hit() finds nothing to describe
    return {};
  }

 private:
  volume::Brick brick_;
};

}  // namespace

Result<residency::PackedBlock> GridKind::load(const model::ModelFile& model, uint32_t block, bool attributes) const {
  const Result<volume::Brick> brick = volume::read_brick(model, block);
  if (!brick) return fail(brick.error());
  const Result<model::StoredBlock> stored = model.stored(block);
  if (!stored) return fail(stored.error());
  residency::PackedBlock packed;
  packed.lattice = {stored->grid, stored->origin, glm::ivec3(0), stored->extent};
  packed.texels = volume::pack_brick(*brick);
  if (attributes) packed.attributes.resize(packed.texels.size());
  const model::Volume& volume = model.volumes()[brick->header.volume];
  packed.header = std::make_shared<const BrickBlock>(*brick, volume.size, volume.index_to_world);
  return packed;
}

Result<std::shared_ptr<const SourceBlock>> GridKind::decode(const model::ModelFile& model, uint32_t block) const {
  Result<volume::Brick> brick = volume::read_brick(model, block);
  if (!brick) return fail(std::move(brick.error()));
  return std::make_shared<const GridBlock>(std::move(*brick));
}

}  // namespace surfcast::kinds
