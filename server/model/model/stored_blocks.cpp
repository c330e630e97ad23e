#include "model/stored_blocks.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/contract.h"

namespace surfcast::model {
namespace {

/// Memory for the block that this thread reads. It is used again, so that decoding takes none anew.
std::span<std::byte> buffer_of_thread(size_t size) {
  constexpr size_t kKept = size_t{8} << 20;  // more than the blocks of any model that was built
  thread_local std::vector<std::byte> buffer;
  if (buffer.size() > kKept && size <= kKept) buffer = {};
  if (buffer.size() < size) buffer.resize(size);
  return std::span(buffer).first(size);
}

}  // namespace

StoredBlocks::StoredBlocks(std::unique_ptr<const ByteSource> source, std::shared_ptr<BlockCache> cache,
                           std::shared_ptr<const Directory> directory, int color_bits, std::vector<bool> coarse)
    : source_(std::move(source)),
      cache_(std::move(cache)),
      directory_(std::move(directory)),
      color_bits_(color_bits),
      coarse_(std::move(coarse)) {
  std::copy_if(directory_->scalars.begin(), directory_->scalars.end(), std::back_inserter(coarse_scalars_),
               [](const ScalarColumn& scalar) { return scalar.coarse; });
}

ByteRange StoredBlocks::range_of(size_t block) const {
  SURFCAST_EXPECTS(block < directory_->blocks.size());
  return {directory_->blocks[block].offset, directory_->blocks[block].bytes};
}

void StoredBlocks::prefetch(std::span<const uint32_t> blocks) const {
  std::vector<ByteRange> ranges;
  ranges.reserve(blocks.size());
  for (const uint32_t block : blocks) {
    const ByteRange range = range_of(block);
    const uint64_t checksum = directory_->blocks[block].checksum;
    if (!cache_ || !cache_->contains(checksum, range.size)) ranges.push_back(range);
  }
  source_->prefetch(ranges);
}

void StoredBlocks::forget(size_t block) const {
  source_->forget(range_of(block));
}

Result<StoredBlock> StoredBlocks::stored(size_t block) const {
  SURFCAST_EXPECTS(block < directory_->blocks.size());
  const BlockRecord& record = directory_->blocks[block];
  // What is checked is what is decoded: the file may be overwritten at any time.
  const std::span<std::byte> bytes = buffer_of_thread(record.bytes);
  const StoredBlock stored_block{
      bytes, directory_->grids[record.grid], record.origin, record.extent, record.items, record.scatter};
  if (cache_ && cache_->read(record.checksum, bytes)) return stored_block;
  if (Status read = source_->read(record.offset, bytes); !read) return fail(read);
  if (checksum_of(bytes) != record.checksum) return fail(ErrorKind::kInvalidInput, "damaged");
  if (cache_) cache_->write(record.checksum, bytes);
  return stored_block;
}

Result<DecodedBlock> StoredBlocks::decode(size_t block, WantedScalars scalars) const {
  const Result<StoredBlock> stored_block = stored(block);
  if (!stored_block) return fail(stored_block);
  const BlockRecord& record = directory_->blocks[block];
  if (directory_->kinds[record.kind] != kSurfelKind) return fail(ErrorKind::kUnsupported, "has no surfels");
  BlockShape shape;
  shape.grid = stored_block->grid;
  shape.origin = stored_block->origin;
  shape.extent = stored_block->extent;
  shape.surfels = stored_block->items;
  shape.scatter = record.scatter;
  shape.color_bits = color_bits_;
  shape.scalars = coarse_[block] ? coarse_scalars_ : directory_->scalars;
  return decode_block(stored_block->bytes, shape, count_of(scalars, shape.scalars));
}

}  // namespace surfcast::model
