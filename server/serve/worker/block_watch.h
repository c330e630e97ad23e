#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "base/file_source.h"
#include "ldc/block_tree.h"
#include "worker/shared_board.h"

namespace surfcast::worker {

/// Notes on the board which block the one thread of a query worker works on: the one that it has read last. So whatever
/// decodes blocks, and however, need not know that it is watched.
class BlockWatch {
 public:
  /// `board` must outlive the watch.
  explicit BlockWatch(const SharedBoard& board) : board_(board) {}

  void reads(const BoardBlock& block);
  /// The question has been answered.
  void ends();

 private:
  const SharedBoard& board_;
  size_t slot_ = kBoardSlots;
};

/// A model file whose blocks are watched, and not read if they are quarantined.
class WatchedFile : public ByteSource {
 public:
  /// `watch` must outlive the file.
  WatchedFile(FileSource file, BlockWatch& watch) : file_(std::move(file)), watch_(watch) {}

  /// Before any block is read. `model`: its number on the board.
  void begin(uint64_t model, std::span<const ldc::BlockEntry> blocks, std::span<const uint32_t> quarantined);

  [[nodiscard]] const std::string& name() const override { return file_.name(); }
  [[nodiscard]] uint64_t size() const override { return file_.size(); }
  [[nodiscard]] Status read(uint64_t offset, std::span<std::byte> bytes) const override;
  void prefetch(std::span<const ByteRange> ranges) const override { file_.prefetch(ranges); }

 private:
  FileSource file_;
  BlockWatch& watch_;
  uint64_t model_ = 0;
  std::map<uint64_t, uint32_t> blocks_;  ///< by offset
  std::set<uint32_t> quarantined_;
};

}  // namespace surfcast::worker
