#pragma once

#include <vector>

#include "ellipsoid/pack_ellipsoids.h"
#include "model/ellipsoid_source.h"
#include "residency/packed_block.h"

namespace surfcast::kinds {

/// The header of a block of ellipsoids (DrawnAs::kGlyphs). Its texels are those of ellipsoid::pack_ellipsoids.
class GlyphBlock : public residency::BlockHeader {
 public:
  GlyphBlock(const ellipsoid::EllipsoidBlock& block, model::EllipsoidSource source);

  /// What the block is of.
  [[nodiscard]] const model::EllipsoidSource& source() const { return source_; }
  [[nodiscard]] bool colored() const { return colored_; }

  [[nodiscard]] glm::vec4 scale(int unit) const override;
  void add_runs(const selection::RadiusRange& wanted, std::vector<residency::TexelRun>& runs) const override;

 private:
  model::EllipsoidSource source_;
  uint32_t each_;  ///< texels of an ellipsoid
  size_t items_;
  bool colored_;
};

/// A decoded block, packed for the GPU.
residency::PackedBlock pack_glyphs(const ellipsoid::EllipsoidBlock& block, const model::EllipsoidSource& source,
                                   bool attributes);

}  // namespace surfcast::kinds
