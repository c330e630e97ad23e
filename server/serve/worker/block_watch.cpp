#include "worker/block_watch.h"

namespace surfcast::worker {

void BlockWatch::reads(const BoardBlock& block) {
  ends();
  slot_ = board_.note(block);
  ++board_.progress();
}

void BlockWatch::ends() {
  board_.clear(slot_);
  slot_ = kBoardSlots;
}

void WatchedFile::begin(uint64_t model, std::span<const ldc::BlockEntry> blocks,
                        std::span<const uint32_t> quarantined) {
  model_ = model;
  for (uint32_t i = 0; i < blocks.size(); ++i) blocks_.emplace(blocks[i].offset, i);
  quarantined_ = {quarantined.begin(), quarantined.end()};
}

Status WatchedFile::read(uint64_t offset, std::span<std::byte> bytes) const {
  const auto found = blocks_.find(offset);
  if (found == blocks_.end()) return file_.read(offset, bytes);
  if (quarantined_.contains(found->second)) {
    return fail(ErrorKind::kInvalidInput, "not loaded any more, because it has ended two query workers");
  }
  watch_.reads({model_, found->second});
  return file_.read(offset, bytes);
}

}  // namespace surfcast::worker
