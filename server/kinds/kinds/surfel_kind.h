#pragma once

#include "kinds/kind.h"

namespace surfcast::kinds {

/// Surfels: oriented discs, the kind of scans.
class SurfelKind : public Kind {
 public:
  [[nodiscard]] std::string_view name() const override { return model::kSurfelKind; }
  [[nodiscard]] Result<residency::PackedBlock> load(const model::ModelFile& model, uint32_t block,
                                                    bool attributes) const override;
  [[nodiscard]] Result<std::shared_ptr<const SourceBlock>> decode(const model::ModelFile& model,
                                                                  uint32_t block) const override;
  [[nodiscard]] KindShaders shaders() const override { return {"#include \"project.comp\"\n", {}}; }
};

}  // namespace surfcast::kinds
