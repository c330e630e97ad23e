#include <algorithm>
#include <utility>

#include "gaussian/gaussian_block.h"
#include "gaussian/pack_gaussians.h"
#include "kinds/built_in_kinds.h"
#include "kinds/decoded_gaussians.h"
#include "residency/block_pool.h"
#include "shared/frame_layout.h"
#include "shared/gaussian_layout.h"

namespace surfcast::kinds {
namespace {

constexpr uint32_t kPage = residency::BlockPool::kPageTexels;

Result<gaussian::GaussianBlock> decode_gaussian_block(const model::ModelFile& model, uint32_t block) {
  const Result<model::StoredBlock> stored = model.stored(block);
  if (!stored) return fail(stored);
  Result<gaussian::GaussianBlock> decoded = gaussian::decode_gaussians(*stored);
  if (!decoded) return fail(model.named(block, decoded.error()));
  if (decoded->codes.traits.degree > model.part(block).model.info().harmonics_degree) {
    return fail(model.named(block, {ErrorKind::kInvalidInput, "harmonics of a higher degree than the model states"}));
  }
  return decoded;
}

class GaussianHeader : public residency::BlockHeader {
 public:
  GaussianHeader(const gaussian::GaussianCodes& codes, double log2_zero)
      : traits_(codes.traits), ranges_(codes.ranges), log2_zero_(log2_zero), items_(codes.size()) {}

  [[nodiscard]] glm::vec4 scale(int unit) const override {
    const auto pair = [&](size_t i) { return static_cast<float>(ranges_.at(i) + 256 * ranges_.at(i + 1)); };
    return {std::ldexp(1.0F, unit), static_cast<float>(log2_zero_ + unit), pair(0), pair(2)};
  }
  void add_runs(const selection::RadiusRange& /*wanted*/, std::vector<residency::TexelRun>& runs) const override {
    const uint32_t each = gaussian::texels_per_gaussian(traits_.degree);
    const size_t in_page = kPage / each;
    const size_t in_run = SURFCAST_CHUNK / each;
    for (size_t first = 0; first < items_;) {
      const size_t count = std::min({in_run, in_page - first % in_page, items_ - first});
      const size_t texel = first / in_page * kPage + first % in_page * each;
      runs.push_back({static_cast<uint32_t>(texel), static_cast<uint32_t>(count * each), flags()});
      first += count;
    }
  }

 private:
  [[nodiscard]] uint32_t flags() const {
    return (static_cast<uint32_t>(traits_.degree) << SURFCAST_RUN_DEGREE_SHIFT) |
           (traits_.antialiased ? SURFCAST_RUN_ANTIALIASED : 0) | (traits_.flat ? SURFCAST_RUN_FLAT : 0);
  }

  gaussian::BlockTraits traits_;
  std::array<uint8_t, gaussian::kMaxDegree> ranges_;
  double log2_zero_;
  size_t items_;
};

}  // namespace

std::string_view GaussianKind::name() const {
  return gaussian::kGaussianKind;
}

uint64_t GaussianKind::texels(const model::ModelInfo& info, uint32_t items) const {
  return gaussian::packed_texels(items, info.harmonics_degree, kPage);
}

Result<residency::PackedBlock> GaussianKind::load(const model::ModelFile& model, uint32_t block,
                                                  bool attributes) const {
  const Result<gaussian::GaussianBlock> decoded = decode_gaussian_block(model, block);
  if (!decoded) return fail(decoded);
  gaussian::PackedGaussians packed = gaussian::pack_gaussians(decoded->codes, kPage);
  residency::PackedBlock result;
  result.lattice = {decoded->grid, decoded->origin, glm::ivec3(0), decoded->extent};
  result.header = std::make_shared<const GaussianHeader>(decoded->codes, packed.log2_zero);
  if (attributes) result.attributes.resize(packed.texels.size());
  result.texels = std::move(packed.texels);
  return result;
}

Result<std::shared_ptr<const SourceBlock>> GaussianKind::decode(const model::ModelFile& model, uint32_t block) const {
  Result<gaussian::GaussianBlock> decoded = decode_gaussian_block(model, block);
  if (!decoded) return fail(decoded);
  return std::make_shared<const DecodedGaussians>(std::move(*decoded));
}

}  // namespace surfcast::kinds
