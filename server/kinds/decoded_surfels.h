#pragma once

#include "kinds/source_block.h"
#include "model/model_file.h"

namespace surfcast::kinds {

/// A decoded block of surfels for picking.
class DecodedSurfels : public SourceBlock {
 public:
  DecodedSurfels(model::DecodedBlock block, const model::ModelInfo& info);

  [[nodiscard]] size_t bytes() const override;
  /// Tests the opaque discs of the surfels (hit_disc).
  void hit(const PickQuery& query, std::vector<PickHit>& hits) const override;
  [[nodiscard]] PickedSurfel describe(const PickQuery& query, uint32_t surfel) const override;

 private:
  [[nodiscard]] bool hidden(const PickQuery& query, size_t surfel) const;
  [[nodiscard]] glm::u8vec3 color_of(size_t surfel) const;

  model::DecodedBlock block_;
  bool oriented_;
  int color_bits_;
};

}  // namespace surfcast::kinds
