#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "ldc/coarse_surfel.h"
#include "ldc/reduce.h"
#include "model/block_decoder.h"
#include "model/block_provider.h"
#include "model/joined_model.h"
#include "model/model_file.h"

namespace surfcast::model {

/// The blocks of a joined model. Errors name the member's file and its block.
class JoinedBlocks : public BlockProvider {
 public:
  /// `info` and `scalars`: of the joined model.
  JoinedBlocks(std::shared_ptr<const JoinedParts> parts, const ModelInfo& info, std::vector<ScalarColumn> scalars);

  void prefetch(std::span<const uint32_t> blocks) const override;
  void forget(size_t block) const override;
  [[nodiscard]] uint64_t unit_of(uint32_t block) const override;
  [[nodiscard]] Result<StoredBlock> stored(size_t block) const override;
  [[nodiscard]] Result<DecodedBlock> decode(size_t block, WantedScalars scalars) const override;
  [[nodiscard]] std::span<const ScalarColumn> scalars() const override { return scalars_; }
  [[nodiscard]] Result<Georeference> georeference() const override;
  /// Of the first member.
  [[nodiscard]] const ByteSource& source() const override { return parts_->members.front().model->source(); }

 private:
  /// The surfels of a shared block, kept from when they are first asked for: blocks above are made of them.
  struct Made {
    std::mutex mutex;  ///< held while they are made; those of blocks below are locked after those above
    std::shared_ptr<const ldc::CoarseCell> cell;
    std::atomic<bool> done = false;
  };

  [[nodiscard]] Result<DecodedBlock> decode_own(const BlockOrigin& origin, WantedScalars scalars) const;
  [[nodiscard]] Result<DecodedBlock> decode_shared(uint32_t shared, WantedScalars scalars) const;
  [[nodiscard]] Result<std::shared_ptr<const ldc::CoarseCell>> cell_of(uint32_t shared) const;
  [[nodiscard]] Result<std::vector<ldc::CoarseSurfel>> surfels_below(uint32_t shared) const;
  [[nodiscard]] Result<std::vector<ldc::CoarseSurfel>> surfels_of(uint32_t block) const;
  void add_sources(uint32_t block, std::vector<std::vector<uint32_t>>& own) const;

  std::shared_ptr<const JoinedParts> parts_;
  ModelInfo info_;  ///< of the joined model
  std::vector<ScalarColumn> scalars_;
  std::vector<ScalarColumn> coarse_scalars_;  ///< scalar attributes of coarse blocks
  std::unique_ptr<Made[]> made_;              ///< of each shared block
};

}  // namespace surfcast::model
