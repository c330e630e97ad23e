#pragma once

#include <span>
#include <vector>

#include "model/block_decoder.h"
#include "model/block_provider.h"
#include "model/joined_model.h"
#include "model/model_file.h"

namespace surfcast::model {

/// The part of its member that a block of a joined model is.
[[nodiscard]] Part part_of(std::span<const Member> members, std::span<const MemberOffsets> offsets, uint32_t block);

/// The blocks of a joined model. Errors name the member's file and its block.
class JoinedBlocks : public BlockProvider {
 public:
  /// `info` and `scalars`: of the joined model.
  JoinedBlocks(std::vector<Member> members, std::vector<MemberOffsets> offsets, const ModelInfo& info,
               std::vector<ScalarColumn> scalars);

  void prefetch(std::span<const uint32_t> blocks) const override;
  void forget(size_t block) const override;
  [[nodiscard]] Result<StoredBlock> stored(size_t block) const override;
  [[nodiscard]] Result<DecodedBlock> decode(size_t block, WantedScalars scalars) const override;
  [[nodiscard]] std::span<const ScalarColumn> scalars() const override { return scalars_; }
  [[nodiscard]] Result<Georeference> georeference() const override;
  /// Of the first member.
  [[nodiscard]] const ByteSource& source() const override { return members_.front().model->source(); }

 private:
  [[nodiscard]] Part part(size_t block) const { return part_of(members_, offsets_, static_cast<uint32_t>(block)); }

  std::vector<Member> members_;
  std::vector<MemberOffsets> offsets_;  ///< of each member
  int color_bits_;
  std::vector<ScalarColumn> scalars_;
  std::vector<ScalarColumn> coarse_scalars_;  ///< scalar attributes of coarse blocks
};

}  // namespace surfcast::model
