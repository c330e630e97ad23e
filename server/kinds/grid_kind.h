#pragma once

#include "kinds/kind.h"

namespace surfcast::kinds {

/// Bricks of volumes. They have no projection: a pass of their own samples their texels (volume/packing.h).
class GridKind : public Kind {
 public:
  [[nodiscard]] std::string_view name() const override { return model::kGridKind; }
  /// `BlockHeader::scale` is the offset and the scale of the codes, then the lowest and the highest value.
  [[nodiscard]] Result<residency::PackedBlock> load(const model::ModelFile& model, uint32_t block,
                                                    bool attributes) const override;
  [[nodiscard]] Result<std::shared_ptr<const SourceBlock>> decode(const model::ModelFile& model,
                                                                  uint32_t block) const override;
  [[nodiscard]] KindShaders shaders() const override { return {}; }
};

}  // namespace surfcast::kinds
