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

/// Bricks of volumes. They have no projection: a pass of their own samples their texels (volume/packing.h).
class GridKind : public Kind {
 public:
  [[nodiscard]] std::string_view name() const override { return model::kGridKind; }
  /// The header is a BrickBlock.
  [[nodiscard]] Result<residency::PackedBlock> load(const model::ModelFile& model, uint32_t block,
                                                    bool attributes) const override;
  [[nodiscard]] Result<std::shared_ptr<const SourceBlock>> decode(const model::ModelFile& model,
                                                                  uint32_t block) const override;
  [[nodiscard]] KindShaders shaders() const override { return {}; }
  [[nodiscard]] DrawnAs drawn_as() const override { return DrawnAs::kVolume; }
  [[nodiscard]] uint64_t texels(const model::ModelInfo& info, uint32_t items) const override;
};

/// Gaussians of trained models (gaussian/gaussian_block.h).
class GaussianKind : public Kind {
 public:
  [[nodiscard]] std::string_view name() const override;
  [[nodiscard]] Result<residency::PackedBlock> load(const model::ModelFile& model, uint32_t block,
                                                    bool attributes) const override;
  [[nodiscard]] Result<std::shared_ptr<const SourceBlock>> decode(const model::ModelFile& model,
                                                                  uint32_t block) const override;
  [[nodiscard]] KindShaders shaders() const override { return {}; }
  [[nodiscard]] DrawnAs drawn_as() const override { return DrawnAs::kGaussians; }
  [[nodiscard]] uint64_t texels(const model::ModelInfo& info, uint32_t items) const override;
};

/// The ellipsoids of tensor fields and tables (ellipsoid/ellipsoid_block.h).
class EllipsoidKind : public Kind {
 public:
  [[nodiscard]] std::string_view name() const override;
  [[nodiscard]] Result<residency::PackedBlock> load(const model::ModelFile& model, uint32_t block,
                                                    bool attributes) const override;
  [[nodiscard]] Result<std::shared_ptr<const SourceBlock>> decode(const model::ModelFile& model,
                                                                  uint32_t block) const override;
  [[nodiscard]] KindShaders shaders() const override { return {}; }
  [[nodiscard]] DrawnAs drawn_as() const override { return DrawnAs::kGlyphs; }
  [[nodiscard]] uint64_t texels(const model::ModelInfo& info, uint32_t items) const override;
};

}  // namespace surfcast::kinds
