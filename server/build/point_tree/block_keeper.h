#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "model/block_cache.h"
#include "model/block_decoder.h"
#include "model/decoded_block.h"
#include "point_tree/make_blocks.h"

namespace surfcast::point_tree {

/// Keeps made blocks on disk, coded as in a model file. Coding takes as long as decoding ten times, so that a thread of
/// idle priority does it. What does not fit into its queue is not kept. Thread-safe.
class BlockKeeper {
 public:
  /// `identity`: what the blocks are made of, and how. `scalars`: of all blocks. `most_waiting`: bytes of blocks that
  /// wait to be coded; where that is used up, blocks are not kept.
  BlockKeeper(std::shared_ptr<model::BlockCache> cache, std::string identity, int color_bits,
              std::vector<model::ScalarColumn> scalars, size_t most_waiting);
  ~BlockKeeper();
  BlockKeeper(const BlockKeeper&) = delete;
  BlockKeeper& operator=(const BlockKeeper&) = delete;

  [[nodiscard]] bool contains(uint32_t block) const;
  /// The block as it was made, with the first of its attributes, up to the last that is wanted; none if it is not kept.
  [[nodiscard]] std::optional<model::DecodedBlock> find(uint32_t block, model::WantedScalars wanted) const;
  /// The blocks of a node.
  void keep(const std::vector<MadeBlock>& blocks);

 private:
  /// The blocks of a node that wait.
  struct Waiting {
    std::vector<MadeBlock> blocks;
    size_t bytes = 0;
  };

  [[nodiscard]] std::string key_of(uint32_t block) const;
  void work();
  [[nodiscard]] std::optional<Waiting> next();

  const std::shared_ptr<model::BlockCache> cache_;
  const std::string identity_;
  const int color_bits_;
  const std::vector<model::ScalarColumn> scalars_;
  const size_t most_waiting_;
  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable wake_;
  std::deque<Waiting> queue_;
  size_t waiting_bytes_ = 0;  ///< with the node whose blocks are being coded
  bool stopping_ = false;
  std::jthread thread_;
};

/// The bytes of a block, with its shape.
std::vector<std::byte> encode_made(const MadeBlock& block);
/// The inverse, with the first of its attributes, up to the last that is wanted; none for other bytes.
std::optional<model::DecodedBlock> decode_made(std::span<const std::byte> bytes, int color_bits,
                                               std::span<const model::ScalarColumn> scalars,
                                               model::WantedScalars wanted);

}  // namespace surfcast::point_tree
