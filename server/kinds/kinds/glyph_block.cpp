#include "kinds/glyph_block.h"

#include <cmath>
#include <utility>

#include "model/model_file.h"
#include "residency/block_pool.h"
#include "shared/ellipsoid_layout.h"
#include "shared/frame_layout.h"

namespace surfcast::kinds {
namespace {

constexpr uint32_t kGlyphPage = residency::BlockPool::kPageTexels;

}  // namespace

GlyphBlock::GlyphBlock(const ellipsoid::EllipsoidBlock& block, model::EllipsoidSource source)
    : source_(std::move(source)),
      each_(ellipsoid::texels_per_ellipsoid(block.scalars.size())),
      items_(block.size()),
      colored_(!block.colors.empty()) {}

glm::vec4 GlyphBlock::scale(int unit) const {
  return {std::ldexp(1.0F, unit), 0, 0, 0};
}

void GlyphBlock::add_runs(const selection::RadiusRange& /*wanted*/, std::vector<residency::TexelRun>& runs) const {
  const size_t in_page = kGlyphPage / each_;
  const size_t in_run = SURFCAST_CHUNK / each_;
  const uint32_t flags = (each_ << SURFCAST_RUN_ELLIPSOID_SHIFT) | (colored_ ? SURFCAST_RUN_ELLIPSOID_COLORED : 0U);
  for (size_t first = 0; first < items_;) {
    const size_t count = std::min({in_run, in_page - first % in_page, items_ - first});
    const size_t texel = first / in_page * kGlyphPage + first % in_page * each_;
    runs.push_back({static_cast<uint32_t>(texel), static_cast<uint32_t>(count * each_), flags});
    first += count;
  }
}

residency::PackedBlock pack_glyphs(const ellipsoid::EllipsoidBlock& block, const model::EllipsoidSource& source,
                                   bool attributes) {
  residency::PackedBlock packed;
  packed.lattice = {block.grid, block.origin, glm::ivec3(0), block.extent};
  packed.texels = ellipsoid::pack_ellipsoids(block, kGlyphPage);
  if (attributes) packed.attributes.resize(packed.texels.size());
  packed.header = std::make_shared<const GlyphBlock>(block, source);
  return packed;
}

}  // namespace surfcast::kinds
