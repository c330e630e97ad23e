#include <utility>

#include "ellipsoid/ellipsoid_block.h"
#include "ellipsoid/pack_ellipsoids.h"
#include "kinds/built_in_kinds.h"
#include "kinds/decoded_ellipsoids.h"
#include "kinds/glyph_block.h"
#include "residency/block_pool.h"

namespace surfcast::kinds {
namespace {

/// Its source is that of the whole model.
Result<ellipsoid::EllipsoidBlock> decode_ellipsoid_block(const model::ModelFile& model, uint32_t block) {
  const model::Part part = model.part(block);
  const Result<model::StoredBlock> stored = part.model.stored(part.block);
  if (!stored) return fail(stored);
  Result<ellipsoid::EllipsoidBlock> decoded = ellipsoid::decode_ellipsoids(*stored, part.model.ellipsoid_sources());
  if (!decoded) return fail(model.named(block, decoded.error()));
  decoded->source += part.first_ellipsoids;
  return decoded;
}

}  // namespace

std::string_view EllipsoidKind::name() const {
  return model::kEllipsoidKind;
}

uint64_t EllipsoidKind::texels(const model::ModelInfo& info, uint32_t items) const {
  return ellipsoid::packed_texels(items, info.ellipsoid_columns, residency::BlockPool::kPageTexels);
}

Result<residency::PackedBlock> EllipsoidKind::load(const model::ModelFile& model, uint32_t block,
                                                   bool attributes) const {
  const Result<ellipsoid::EllipsoidBlock> decoded = decode_ellipsoid_block(model, block);
  if (!decoded) return fail(decoded);
  return pack_glyphs(*decoded, model.ellipsoid_sources()[decoded->source], attributes);
}

Result<std::shared_ptr<const SourceBlock>> EllipsoidKind::decode(const model::ModelFile& model, uint32_t block) const {
  Result<ellipsoid::EllipsoidBlock> decoded = decode_ellipsoid_block(model, block);
  if (!decoded) return fail(decoded);
  model::EllipsoidSource source = model.ellipsoid_sources()[decoded->source];
  return std::make_shared<const DecodedEllipsoids>(std::move(*decoded), std::move(source));
}

}  // namespace surfcast::kinds
