#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "model/kind_tables.h"

namespace surfcast::model {
namespace {

/// Bytes of a volume with empty strings, and of a brick.
constexpr size_t kVolumeBytes = 3 * 4 + 3 * 4 + 12 * 8 + 1 + 1 + 4 * 8 + kHistogramBins * 8;
constexpr size_t kBrickBytes = 28;

tl::unexpected<Error> damaged_tables(const char* what) {
  return fail(ErrorKind::kInvalidInput, what);
}

void put_volume(ByteWriter& writer, const Volume& volume) {
  writer.put_string(volume.name);
  for (int axis = 0; axis < 3; ++axis) writer.put(volume.size[axis]);
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) writer.put(volume.index_to_world[column][row]);
  }
  writer.put(static_cast<uint8_t>(volume.frame));
  writer.put_string(volume.length_unit);
  writer.put_string(volume.sample_unit);
  writer.put(volume.type);
  for (const double value : {volume.slope, volume.intercept, volume.low, volume.high}) writer.put(value);
  for (const uint64_t count : volume.histogram) writer.put(count);
}

Volume get_volume(ByteReader& reader) {
  Volume volume;
  volume.name = reader.get_string();
  for (int axis = 0; axis < 3; ++axis) volume.size[axis] = reader.get<uint32_t>();
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) volume.index_to_world[column][row] = reader.get<double>();
  }
  volume.frame = static_cast<WorldFrame>(reader.get<uint8_t>());
  volume.length_unit = reader.get_string();
  volume.sample_unit = reader.get_string();
  volume.type = reader.get<uint8_t>();
  for (double* value : {&volume.slope, &volume.intercept, &volume.low, &volume.high}) *value = reader.get<double>();
  volume.histogram.resize(kHistogramBins);
  for (uint64_t& count : volume.histogram) count = reader.get<uint64_t>();
  return volume;
}

bool valid_size(const glm::u32vec3& size) {
  return std::min({size.x, size.y, size.z}) >= 1 && std::max({size.x, size.y, size.z}) <= kMaxAxisSamples;
}

bool valid_place(const glm::dmat4x3& index_to_world) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) {
      if (!std::isfinite(index_to_world[column][row])) return false;
    }
  }
  return true;
}

bool valid_values(const Volume& volume) {
  const bool finite = std::isfinite(volume.slope) && std::isfinite(volume.intercept) && std::isfinite(volume.low) &&
                      std::isfinite(volume.high);
  return finite && volume.slope != 0 && volume.low <= volume.high;
}

/// True if the counts are those of all samples. Their sum does not wrap: each is at most what is left.
bool valid_histogram(const Volume& volume) {
  if (volume.samples() / volume.size.z != uint64_t{volume.size.x} * volume.size.y) return false;  // overflow
  uint64_t left = volume.samples();
  for (const uint64_t count : volume.histogram) {
    if (count > left) return false;
    left -= count;
  }
  return left == 0;
}

bool valid_volume(const Volume& volume) {
  return valid_size(volume.size) && valid_place(volume.index_to_world) &&
         static_cast<uint8_t>(volume.frame) < kWorldFrames && volume.type < std::variant_size_v<surfel::ScalarValues> &&
         valid_values(volume) && valid_histogram(volume);
}

void put_brick(ByteWriter& writer, const BrickRecord& brick) {
  writer.put(brick.volume);
  writer.put(brick.level);
  for (int axis = 0; axis < 3; ++axis) writer.put(brick.brick[axis]);
  writer.put(brick.low);
  writer.put(brick.high);
}

BrickRecord get_brick(ByteReader& reader) {
  BrickRecord brick;
  brick.volume = reader.get<uint32_t>();
  brick.level = reader.get<uint32_t>();
  for (int axis = 0; axis < 3; ++axis) brick.brick[axis] = reader.get<uint32_t>();
  brick.low = reader.get<float>();
  brick.high = reader.get<float>();
  return brick;
}

/// Bricks of a level along an axis, less one: those after the first.
uint64_t further_bricks(uint32_t samples, uint32_t level) {
  return uint64_t{samples - 1} / kBrickSamples >> level;
}

bool is_top(const Volume& volume, uint32_t level) {
  return further_bricks(std::max({volume.size.x, volume.size.y, volume.size.z}), level) == 0;
}

bool valid_brick(const BrickRecord& brick, const Directory& directory) {
  constexpr uint32_t kMaxLevel = 31;
  if (brick.volume >= directory.volumes.size() || brick.level > kMaxLevel) return false;
  const Volume& volume = directory.volumes[brick.volume];
  if (brick.level > 0 && is_top(volume, brick.level - 1)) return false;
  for (int axis = 0; axis < 3; ++axis) {
    if (brick.brick[axis] > further_bricks(volume.size[axis], brick.level)) return false;
  }
  return std::isfinite(brick.low) && std::isfinite(brick.high) && brick.low <= brick.high;
}

}  // namespace

void put_volumes(ByteWriter& writer, const Directory& directory) {
  writer.put(static_cast<uint32_t>(directory.volumes.size()));
  for (const Volume& volume : directory.volumes) put_volume(writer, volume);
  for (const BlockRecord& block : directory.blocks) {
    if (directory.kinds[block.kind] == kGridKind) put_brick(writer, directory.bricks[block.brick]);
  }
}

Status get_volumes(ByteReader& reader, Directory& directory) {
  const auto volumes = reader.get<uint32_t>();
  if (volumes > reader.rest().size() / kVolumeBytes) return damaged_tables("model tables have a wrong length");
  for (uint32_t i = 0; i < volumes; ++i) {
    directory.volumes.push_back(get_volume(reader));
    if (!reader.ok() || !valid_volume(directory.volumes.back())) return damaged_tables("model has a wrong volume");
  }
  for (BlockRecord& block : directory.blocks) {
    if (directory.kinds[block.kind] != kGridKind) continue;
    if (reader.rest().size() < kBrickBytes) return damaged_tables("model tables have a wrong length");
    block.brick = static_cast<uint32_t>(directory.bricks.size());
    directory.bricks.push_back(get_brick(reader));
    if (!valid_brick(directory.bricks.back(), directory)) return damaged_tables("model has a wrong brick");
  }
  return {};
}

bool is_within_pyramid(const Directory& directory, const BlockRecord& block) {
  const BrickRecord& brick = directory.bricks[block.brick];
  if (block.parent == ldc::BlockEntry::kNoParent) return is_top(directory.volumes[brick.volume], brick.level);
  const BrickRecord& parent = directory.bricks[directory.blocks[block.parent].brick];
  return parent.volume == brick.volume && parent.level == brick.level + 1 && parent.brick == brick.brick / 2U;
}

}  // namespace surfcast::model
