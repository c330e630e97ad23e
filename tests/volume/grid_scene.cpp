#include "volume/grid_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "kinds/brick_block.h"

namespace surfcast::testing {
namespace {

constexpr double kLargestCode = 65535;

/// What a block holds before its codes.
struct PlainBrick {
  volume::BrickHeader header;
  glm::u32vec3 size{0};
  glm::dmat4x3 index_to_world{1.0};
};

struct Quantiser {
  double offset = 0;
  double scale = 1;

  [[nodiscard]] uint16_t code(double value) const {
    return static_cast<uint16_t>(std::lround(std::clamp((value - offset) / scale, 0.0, kLargestCode)));
  }
};

Quantiser quantiser_of(const reference::VolumeGrid& grid) {
  const auto [low, high] = std::ranges::minmax_element(grid.values);
  return {*low, *high > *low ? (*high - *low) / kLargestCode : 1};
}

std::vector<uint16_t> codes_of(const reference::VolumeGrid& level, const volume::BrickHeader& header,
                               const Quantiser& quantiser) {
  const glm::ivec3 size(volume::stored_size(header.count));
  const glm::ivec3 first = glm::ivec3(header.brick * volume::kBrickSamples) - static_cast<int>(volume::kHaloBefore);
  std::vector<uint16_t> codes;
  for (int k = 0; k < size.z; ++k) {
    for (int j = 0; j < size.y; ++j) {
      for (int i = 0; i < size.x; ++i) codes.push_back(quantiser.code(level.at(first + glm::ivec3(i, j, k))));
    }
  }
  return codes;
}

model::EncodedBlock encoded(const PlainBrick& brick, const std::vector<uint16_t>& codes) {
  model::EncodedBlock block;
  block.kind = PlainBrickKind().name();
  const volume::IndexBox box = volume::brick_box(brick.size, brick.header.level, brick.header.brick);
  glm::dvec3 low(std::numeric_limits<double>::max());
  glm::dvec3 high = -low;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::bvec3 upper(corner & 1, corner & 2, corner & 4);
    const glm::dvec3 place = brick.index_to_world * glm::dvec4(glm::mix(box.low, box.high, upper), 1);
    low = glm::min(low, place);
    high = glm::max(high, place);
  }
  const glm::dmat3 axes(brick.index_to_world[0], brick.index_to_world[1], brick.index_to_world[2]);
  const double step = std::max({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
  constexpr double kLattice = 4096;
  block.grid = {glm::dvec3(step / kLattice), low};
  block.extent = glm::u32vec3(glm::ceil((high - low) / block.grid.scale));
  block.items = volume::brick_items(brick.header.count);
  block.spacing = static_cast<float>(1.08 * std::ldexp(step, static_cast<int>(brick.header.level)));
  block.max_radius = block.spacing;
  block.bytes.resize(sizeof brick + codes.size() * sizeof(uint16_t));
  std::memcpy(block.bytes.data(), &brick, sizeof brick);
  std::memcpy(block.bytes.data() + sizeof brick, codes.data(), codes.size() * sizeof(uint16_t));
  return block;
}

Result<std::pair<PlainBrick, std::vector<uint16_t>>> read(const model::ModelFile& model, uint32_t block) {
  const Result<model::StoredBlock> stored = model.stored(block);
  if (!stored) return fail(stored);
  PlainBrick brick;
  std::memcpy(&brick, stored->bytes.data(), sizeof brick);
  std::vector<uint16_t> codes((stored->bytes.size() - sizeof brick) / sizeof(uint16_t));
  std::memcpy(codes.data(), stored->bytes.data() + sizeof brick, codes.size() * sizeof(uint16_t));
  return std::pair(brick, std::move(codes));
}

using BrickNumbers = std::map<std::array<uint32_t, 3>, uint32_t>;

/// The numbers of the children of a brick.
std::vector<uint32_t> children_of(const glm::u32vec3& brick, const BrickNumbers& finer) {
  std::vector<uint32_t> children;
  for (uint32_t octant = 0; octant < 8; ++octant) {
    const auto found =
        finer.find({2 * brick.x + (octant & 1U), 2 * brick.y + (octant >> 1 & 1U), 2 * brick.z + (octant >> 2)});
    if (found != finer.end()) children.push_back(found->second);
  }
  return children;
}

}  // namespace

Result<residency::PackedBlock> PlainBrickKind::load(const model::ModelFile& model, uint32_t block,
                                                    bool /*attributes*/) const {
  const auto found = read(model, block);
  if (!found) return fail(found);
  const auto& [plain, codes] = *found;
  const volume::Brick brick{plain.header, codes};
  residency::PackedBlock packed;
  const Result<model::StoredBlock> stored = model.stored(block);
  packed.lattice = {stored->grid, stored->origin, glm::ivec3(0), stored->extent};
  packed.texels = volume::pack_brick(brick);
  packed.header = std::make_shared<const kinds::BrickBlock>(brick, plain.size, plain.index_to_world);
  return packed;
}

Result<std::shared_ptr<const kinds::SourceBlock>> PlainBrickKind::decode(const model::ModelFile& model,
                                                                         uint32_t block) const {
  return fail(model.named(block, {ErrorKind::kUnsupported, "plain bricks are not picked"}));
}

kinds::KindTable kinds_with_plain_bricks() {
  static const PlainBrickKind kBricks;
  static const std::array<const kinds::Kind*, 2> kKinds{kinds::built_in_kinds().front(), &kBricks};
  return kKinds;
}

void add_volume(model::ModelWriter& writer, const reference::VolumeGrid& grid, BrickOrder order) {
  const glm::u32vec3 size(grid.size);
  const Quantiser quantiser = quantiser_of(grid);
  const uint32_t levels = volume::level_count(size);
  reference::VolumeGrid level = grid;
  BrickNumbers finer;
  for (uint32_t l = 0; l < levels; ++l) {
    BrickNumbers numbers;
    const glm::u32vec3 bricks = volume::level_bricks(size, l);
    const uint32_t all = bricks.x * bricks.y * bricks.z;
    for (uint32_t n = 0; n < all; ++n) {
      const uint32_t i = order == BrickOrder::kForward ? n : all - 1 - n;
      const glm::u32vec3 b(i % bricks.x, i / bricks.x % bricks.y, i / bricks.x / bricks.y);
      PlainBrick brick{{0, l, b, volume::brick_count(size, l, b), quantiser.offset, quantiser.scale, 0, 1},
                       size,
                       glm::dmat4x3(grid.axes[0], grid.axes[1], grid.axes[2], grid.origin)};
      const std::vector<uint16_t> codes = codes_of(level, brick.header, quantiser);
      const ldc::OctreeKey key{static_cast<uint8_t>(levels - 1 - l), b.x, b.y, b.z};
      const Result<uint32_t> added = writer.add(encoded(brick, codes), key, children_of(b, finer));
      EXPECT_TRUE(added) << (added ? "" : added.error().message);
      if (!added) return;
      numbers[{b.x, b.y, b.z}] = *added;
    }
    finer = std::move(numbers);
    level = reference::halved(level);
  }
}

std::filesystem::path write_volume(const std::filesystem::path& target, const reference::VolumeGrid& grid) {
  Result<model::ModelWriter> writer = model::ModelWriter::create(target, {});
  EXPECT_TRUE(writer);
  add_volume(*writer, grid);
  const auto finished = writer->finish();
  EXPECT_TRUE(finished) << (finished ? "" : finished.error().message);
  return target;
}

reference::VolumeGrid as_stored(const reference::VolumeGrid& grid) {
  const Quantiser quantiser = quantiser_of(grid);
  reference::VolumeGrid stored = grid;
  for (double& value : stored.values) value = quantiser.offset + quantiser.scale * quantiser.code(value);
  return stored;
}

}  // namespace surfcast::testing
