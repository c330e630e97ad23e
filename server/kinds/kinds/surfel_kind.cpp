#include <algorithm>
#include <glm/vec2.hpp>
#include <utility>

#include "kinds/built_in_kinds.h"
#include "kinds/decoded_surfels.h"
#include "residency/packing.h"
#include "shared/frame_layout.h"
#include "shared/surfel_layout.h"

namespace surfcast::kinds {
namespace {

uint32_t flags_of(const residency::PackedRun& run) {
  return (run.finest ? SURFCAST_RUN_FINEST : 0) | (run.coarsest ? SURFCAST_RUN_COARSEST : 0) |
         (run.pairs ? SURFCAST_RUN_PAIRS : 0) | (run.scatter ? SURFCAST_RUN_SCATTER : 0);
}

/// True if the projection may draw a surfel of the chunk (shaders/include/spacing.glsl). A margin allows for the
/// rounding of radii to codes.
bool may_be_drawn(const residency::PackedRun& run, const residency::PackedRun::Radii& radii,
                  const selection::RadiusRange& wanted) {
  constexpr double kRounding = 1.02;
  return (run.finest || radii.least <= kRounding * wanted.largest) &&
         (run.coarsest || kRounding * radii.largest_merged > SURFCAST_SPACING_SLACK * wanted.least);
}

class SurfelHeader : public residency::BlockHeader {
 public:
  SurfelHeader(residency::PackedSurfels& packed, bool oriented)
      : radius_(packed.radius),
        weight_(packed.weight),
        flags_((packed.curved ? SURFCAST_RUN_CURVED : 0) | (oriented ? 0 : SURFCAST_RUN_TWO_SIDED)),
        runs_(std::move(packed.runs)) {}

  [[nodiscard]] glm::vec4 scale(int unit) const override {
    const auto scale_of = [](const residency::LogScale& s) {
      return glm::dvec2(s.log2_largest, s.octaves / SURFCAST_SIZE_STEPS);
    };
    return {glm::vec2(scale_of(radius_) + glm::dvec2(unit, 0)), glm::vec2(scale_of(weight_))};
  }

  void add_runs(const selection::RadiusRange& wanted, std::vector<residency::TexelRun>& runs) const override {
    for (const residency::PackedRun& run : runs_) {
      for (uint32_t i = 0; i < run.count; i += SURFCAST_CHUNK) {
        if (!may_be_drawn(run, run.chunks[i / SURFCAST_CHUNK], wanted)) continue;
        runs.push_back({run.first + i, std::min<uint32_t>(run.count - i, SURFCAST_CHUNK), flags_of(run) | flags_});
      }
    }
  }

  [[nodiscard]] size_t centres(const residency::PackedBlock& block) const override {
    return block.texels.size() / texels_of_surfel();
  }
  [[nodiscard]] glm::dvec3 centre(const residency::PackedBlock& block, size_t i) const override {
    const glm::uvec3 code = glm::uvec3(block.texels[i * texels_of_surfel()]) & glm::uvec3(SURFCAST_POSITION_MASK);
    return block.lattice.position(code);
  }

 private:
  [[nodiscard]] size_t texels_of_surfel() const { return (flags_ & SURFCAST_RUN_CURVED) != 0 ? 2 : 1; }

  residency::LogScale radius_;
  residency::LogScale weight_;
  uint32_t flags_;  ///< of all its runs
  std::vector<residency::PackedRun> runs_;
};

}  // namespace

Result<residency::PackedBlock> SurfelKind::load(const model::ModelFile& model, uint32_t block, bool attributes) const {
  const Result<model::DecodedBlock> decoded =
      model.decode(block, attributes ? model::WantedScalars::kDrawn : model::WantedScalars::kNone);
  if (!decoded) return fail(decoded);
  residency::PackedSurfels packed;  // a block that was made of points may have none
  if (decoded->size() > 0) packed = residency::pack_block(*decoded, model.info().color_bits, decoded->oriented);
  if (attributes) residency::pack_attributes(*decoded, packed);
  auto header = std::make_shared<const SurfelHeader>(packed, decoded->oriented);
  return residency::PackedBlock{packed.lattice, std::move(packed.surfels), std::move(packed.attributes),
                                packed.intensity, std::move(header)};
}

Result<std::shared_ptr<const SourceBlock>> SurfelKind::decode(const model::ModelFile& model, uint32_t block) const {
  Result<model::DecodedBlock> decoded = model.decode(block);
  if (!decoded) return fail(decoded);
  return std::make_shared<const DecodedSurfels>(std::move(*decoded), model.info(), model.part(block).model.info());
}

}  // namespace surfcast::kinds
