#include "point_tree/block_keeper.h"

#include <set>
#include <span>

#include "base/idle_priority.h"
#include "model/block_encoder.h"
#include "model/byte_stream.h"
#include "model/format.h"
#include "point_tree/columns.h"

namespace surfcast::point_tree {
namespace {

size_t bytes_of(const surfel::SurfelCloud& cloud) {
  size_t each = sizeof(glm::dvec3) + sizeof(glm::vec3) + 2 * sizeof(float) + 1;
  if (cloud.colors) each += sizeof(glm::u16vec3);
  return (each + bytes_of_scalars(cloud.scalars)) * cloud.size();
}

/// Of blocks with their clouds, which several of them share.
size_t bytes_of(const std::vector<MadeBlock>& blocks) {
  size_t bytes = 0;
  std::set<const surfel::SurfelCloud*> counted;
  for (const MadeBlock& block : blocks) {
    bytes += sizeof(block) + block.members.size() * sizeof(block.members[0]);
    if (counted.insert(block.cloud.get()).second) bytes += bytes_of(*block.cloud);
  }
  return bytes;
}

void write_vector(model::ByteWriter& writer, const glm::dvec3& v) {
  for (int axis = 0; axis < 3; ++axis) writer.put(v[axis]);
}

glm::dvec3 read_vector(model::ByteReader& reader) {
  glm::dvec3 v;
  for (int axis = 0; axis < 3; ++axis) v[axis] = reader.get<double>();
  return v;
}

}  // namespace

std::vector<std::byte> encode_made(const MadeBlock& block) {
  model::ByteWriter writer;
  writer.put(static_cast<uint32_t>(block.members.size()));
  if (block.members.empty()) return std::move(writer).take();
  const model::EncodedBlock encoded = model::encode_block(*block.cloud, block.members, block.grid);
  writer.put(static_cast<uint8_t>(block.cloud->oriented));
  writer.put(encoded.scatter);
  write_vector(writer, encoded.grid.scale);
  write_vector(writer, encoded.grid.offset);
  for (int axis = 0; axis < 3; ++axis) writer.put(encoded.origin[axis]);
  for (int axis = 0; axis < 3; ++axis) writer.put(encoded.extent[axis]);
  writer.put_bytes(encoded.bytes);
  return std::move(writer).take();
}

std::optional<model::DecodedBlock> decode_made(std::span<const std::byte> bytes, int color_bits,
                                               std::span<const model::ScalarColumn> scalars,
                                               model::WantedScalars wanted) {
  model::ByteReader reader(bytes);
  model::BlockShape shape;
  shape.surfels = reader.get<uint32_t>();
  if (!reader.ok() || shape.surfels > model::kMaxBlockSurfels) return std::nullopt;
  if (shape.surfels == 0) return model::DecodedBlock();
  const bool oriented = reader.get<uint8_t>() != 0;
  shape.scatter = reader.get<uint32_t>();
  shape.grid.scale = read_vector(reader);
  shape.grid.offset = read_vector(reader);
  for (int axis = 0; axis < 3; ++axis) shape.origin[axis] = reader.get<int64_t>();
  for (int axis = 0; axis < 3; ++axis) shape.extent[axis] = reader.get<uint32_t>();
  if (!reader.ok()) return std::nullopt;
  shape.color_bits = color_bits;
  shape.scalars = scalars;
  Result<model::DecodedBlock> block = model::decode_block(reader.rest(), shape, model::count_of(wanted, scalars));
  if (block) block->oriented = oriented;
  return block ? std::optional(std::move(*block)) : std::nullopt;
}

BlockKeeper::BlockKeeper(std::shared_ptr<model::BlockCache> cache, std::string identity, int color_bits,
                         std::vector<model::ScalarColumn> scalars, size_t most_waiting)
    : cache_(std::move(cache)),
      identity_(std::move(identity)),
      color_bits_(color_bits),
      scalars_(std::move(scalars)),
      most_waiting_(most_waiting),
      thread_([this] { work(); }) {}

BlockKeeper::~BlockKeeper() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
}

std::string BlockKeeper::key_of(uint32_t block) const {
  return identity_ + '#' + std::to_string(block);
}

bool BlockKeeper::contains(uint32_t block) const {
  return cache_->contains_made(key_of(block));
}

std::optional<model::DecodedBlock> BlockKeeper::find(uint32_t block, model::WantedScalars wanted) const {
  const std::vector<std::byte> bytes = cache_->read_made(key_of(block));
  return bytes.empty() ? std::nullopt : decode_made(bytes, color_bits_, scalars_, wanted);
}

void BlockKeeper::keep(const std::vector<MadeBlock>& blocks) {
  const size_t bytes = bytes_of(blocks);
  {
    const std::lock_guard lock(mutex_);
    if (waiting_bytes_ + bytes > most_waiting_) return;
    waiting_bytes_ += bytes;
    queue_.push_back({blocks, bytes});
  }
  wake_.notify_all();
}

/// Waits. None when the keeper ends: what still waits then is coded first.
std::optional<BlockKeeper::Waiting> BlockKeeper::next() {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
  if (queue_.empty()) return std::nullopt;
  Waiting waiting = std::move(queue_.front());
  queue_.pop_front();
  return waiting;
}

void BlockKeeper::work() {
  use_idle_priority();
  while (const std::optional<Waiting> waiting = next()) {
    for (const MadeBlock& block : waiting->blocks) cache_->write_made(key_of(block.block), encode_made(block));
    const std::lock_guard lock(mutex_);
    waiting_bytes_ -= waiting->bytes;
  }
}

}  // namespace surfcast::point_tree
