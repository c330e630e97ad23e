#pragma once

#include <memory>
#include <vector>

#include "model/block_cache.h"
#include "model/block_decoder.h"
#include "model/block_provider.h"
#include "model/format.h"

namespace surfcast::model {

/// The blocks of a model file, or of an object in a store.
class StoredBlocks : public BlockProvider {
 public:
  /// `coarse`: for each block whether it stands for others. `cache` may be null.
  StoredBlocks(std::unique_ptr<const ByteSource> source, std::shared_ptr<BlockCache> cache,
               std::shared_ptr<const Directory> directory, int color_bits, std::vector<bool> coarse);

  void prefetch(std::span<const uint32_t> blocks) const override;
  void forget(size_t block) const override;
  [[nodiscard]] Result<StoredBlock> stored(size_t block) const override;
  [[nodiscard]] Result<DecodedBlock> decode(size_t block, WantedScalars scalars) const override;
  [[nodiscard]] std::span<const ScalarColumn> scalars() const override { return directory_->scalars; }
  [[nodiscard]] Result<Georeference> georeference() const override { return load_georeference(*source_); }
  [[nodiscard]] const ByteSource& source() const override { return *source_; }

 private:
  [[nodiscard]] ByteRange range_of(size_t block) const;

  std::unique_ptr<const ByteSource> source_;
  std::shared_ptr<BlockCache> cache_;
  std::shared_ptr<const Directory> directory_;
  int color_bits_;
  std::vector<bool> coarse_;
  std::vector<ScalarColumn> coarse_scalars_;  ///< scalar attributes of coarse blocks
};

}  // namespace surfcast::model
