#pragma once

#include <optional>
#include <vector>

#include "ellipsoid/ellipsoid_block.h"
#include "kinds/ellipsoid_ray.h"
#include "kinds/glyph_sight.h"
#include "kinds/source_block.h"
#include "model/ellipsoid_source.h"

namespace surfcast::kinds {

/// The ellipsoids of a block for picks and channels: the nearest one that the ray of a pixel hits, as drawn.
class DecodedEllipsoids : public SourceBlock {
 public:
  DecodedEllipsoids(ellipsoid::EllipsoidBlock block, model::EllipsoidSource source);

  [[nodiscard]] size_t bytes() const override;
  void hit(const PickQuery& query, std::vector<PickHit>& hits) const override;
  void cover(const PickQuery& query, PixelHits& pixels) const override;
  /// Values: fa, mode, md, eigenvalues (or semi-axes), their axes, the tensor, the indices of the sample, and the
  /// columns of the source.
  [[nodiscard]] PickedSurfel describe(const PickQuery& query, uint32_t item) const override;

 private:
  [[nodiscard]] GlyphSight sight(const PickQuery& query) const;
  [[nodiscard]] bool shown(const PickQuery& query, const GlyphSight& sight, size_t i) const;
  [[nodiscard]] double attribute(int number, size_t i) const;
  [[nodiscard]] EllipsoidOnRays on_rays(const PickQuery& query, const GlyphSight& sight, size_t i) const;
  [[nodiscard]] glm::uvec3 sample(size_t i) const;

  ellipsoid::EllipsoidBlock block_;
  model::EllipsoidSource source_;
};

}  // namespace surfcast::kinds
