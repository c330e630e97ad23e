#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "kinds/kind_table.h"
#include "residency/block_source.h"

namespace surfcast::kinds {

/// The blocks of a model file, each loaded by its kind.
class FileBlocks : public residency::BlockSource {
 public:
  /// `numbers`: the result of find_kinds for the model.
  FileBlocks(std::shared_ptr<const model::ModelFile> model, KindTable kinds, std::vector<uint32_t> numbers);

  [[nodiscard]] uint64_t id() const override { return model_->id(); }
  /// The tree of the model. Blocks count as many items as their texels need at kMaxPackedPerSurfel each, so that
  /// budgets are those of memory.
  [[nodiscard]] const ldc::BlockTree& tree() const override { return tree_ ? *tree_ : model_->tree(); }
  void prefetch(std::span<const uint32_t> blocks) const override { model_->prefetch(blocks); }
  void forget(uint32_t block) const override { model_->forget(block); }
  [[nodiscard]] uint64_t unit_of(uint32_t block) const override { return model_->unit_of(block); }
  [[nodiscard]] Result<residency::PackedBlock> load(uint32_t block, bool attributes) const override;
  /// The number of a block's kind in the table of kinds.
  [[nodiscard]] uint32_t kind_of(uint32_t block) const { return numbers_[model_->blocks()[block].kind]; }
  [[nodiscard]] const Kind& kind(uint32_t block) const { return *kinds_[kind_of(block)]; }

 private:
  std::shared_ptr<const model::ModelFile> model_;
  KindTable kinds_;
  std::vector<uint32_t> numbers_;
  std::optional<ldc::BlockTree> tree_;  ///< if it differs from that of the model
};

}  // namespace surfcast::kinds
