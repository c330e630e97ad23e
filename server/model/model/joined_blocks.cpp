#include "model/joined_blocks.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace surfcast::model {

Part part_of(std::span<const Member> members, std::span<const MemberOffsets> offsets, uint32_t block) {
  const auto after = std::ranges::upper_bound(offsets, block, {}, &MemberOffsets::block);
  const auto member = static_cast<uint32_t>(after - offsets.begin()) - 1;
  const MemberOffsets& first = offsets[member];
  return {*members[member].model, block - first.block, member, first.volume, first.ellipsoids};
}

JoinedBlocks::JoinedBlocks(std::vector<Member> members, std::vector<MemberOffsets> offsets, const ModelInfo& info,
                           std::vector<ScalarColumn> scalars)
    : members_(std::move(members)),
      offsets_(std::move(offsets)),
      color_bits_(info.color_bits),
      scalars_(std::move(scalars)) {
  std::ranges::copy_if(scalars_, std::back_inserter(coarse_scalars_), &ScalarColumn::coarse);
}

void JoinedBlocks::prefetch(std::span<const uint32_t> blocks) const {
  std::vector<std::vector<uint32_t>> own(members_.size());
  for (const uint32_t block : blocks) {
    const Part of = part(block);
    own[of.member].push_back(of.block);
  }
  for (size_t i = 0; i < own.size(); ++i) {
    if (!own[i].empty()) members_[i].model->prefetch(own[i]);
  }
}

void JoinedBlocks::forget(size_t block) const {
  const Part own = part(block);
  own.model.forget(own.block);
}

Result<StoredBlock> JoinedBlocks::stored(size_t block) const {
  const Part own = part(block);
  return own.model.stored(own.block);
}

Result<DecodedBlock> JoinedBlocks::decode(size_t block, WantedScalars scalars) const {
  const Part own = part(block);
  Result<DecodedBlock> decoded = own.model.decode(own.block, scalars);
  if (!decoded) return decoded;
  const std::vector<glm::dmat4x3>& places = members_[own.member].places;
  if (!places.empty()) decoded = placed(std::move(*decoded), places[own.block]);
  const bool leaf = own.model.blocks()[own.block].level == 0;
  const std::span<const ScalarColumn> columns = leaf ? scalars_ : coarse_scalars_;
  return conform(std::move(*decoded), own.model.info().color_bits, color_bits_,
                 columns.first(count_of(scalars, columns)), scalars);
}

Result<Georeference> JoinedBlocks::georeference() const {
  Georeference joined;
  for (const Member& member : members_) {
    Result<Georeference> own = member.model->georeference();
    if (!own) return own;
    if (!own->known()) continue;
    if (!joined.known()) {
      joined = std::move(*own);
    } else if (own->source != joined.source) {
      joined.source = {};
    }
  }
  return joined;
}

}  // namespace surfcast::model
