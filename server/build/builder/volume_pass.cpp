#include "builder/volume_pass.h"

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <oneapi/tbb/task_arena.h>

#include "builder/ordered_work.h"
#include "volume/brick_block.h"
#include "volume/brick_coding.h"
#include "volume/pyramid.h"

namespace surfcast::builder {
namespace {

/// Bytes of the entries of a brick in the tables, while they are written.
constexpr double kBytesPerBrick = 512;

/// Integers come back exactly. Their means are rounded to eighths: exact in the first level above the source.
double step_of(const GridInput& input, uint32_t level) {
  if (!input.integral()) return 0;
  return level == 0 ? 1 : 0.125;
}

template <typename Sample>
class VolumePass {
 public:
  VolumePass(GridInput& input, uint32_t number, model::ModelWriter& writer)
      : input_(input),
        number_(number),
        size_(input.volume().size),
        lattice_(volume::bounds_lattice(input.volume())),
        writer_(writer),
        pyramid_(size_, [this](uint32_t level, uint32_t k) { return write_slab(level, k); }),
        blocks_(volume::level_count(size_)) {}

  Status run(StageClock& clock) {
    for (uint32_t k = 0; k < size_.z; ++k) {
      if (Status status = input_.read_plane(pyramid_.next_plane()); !status) return status;
      if (Status status = pyramid_.add_plane(); !status) return status;
      clock.step();
    }
    return {};
  }

 private:
  Status write_slab(uint32_t level, uint32_t k) {
    const glm::u32vec3 bricks = volume::level_bricks(size_, level);
    const auto at_once = 2 * static_cast<size_t>(oneapi::tbb::this_task_arena::max_concurrency());
    return work_in_order(size_t{bricks.x} * bricks.y, at_once, [&](size_t i) -> Result<std::function<Status()>> {
      const glm::u32vec3 brick(static_cast<uint32_t>(i % bricks.x), static_cast<uint32_t>(i / bricks.x), k);
      auto block = std::make_shared<const model::EncodedBlock>(encode(level, brick));
      return [this, level, brick, block] { return add(*block, level, brick); };
    });
  }

  [[nodiscard]] model::EncodedBlock encode(uint32_t level, const glm::u32vec3& brick) const {
    volume::BrickHeader place;
    place.volume = number_;
    place.level = level;
    place.brick = brick;
    place.count = volume::brick_count(size_, level, brick);
    const grid::GridHeader& header = input_.header();
    const volume::SampleScale scale{header.slope, header.intercept, step_of(input_, level)};
    return volume::brick_block(volume::make_brick(place, pyramid_.samples(level, brick), scale), input_.volume(),
                               lattice_);
  }

  Status add(const model::EncodedBlock& block, uint32_t level, const glm::u32vec3& brick) {
    const Result<uint32_t> number =
        writer_.add(block, volume::brick_key(size_, level, brick), children_of(level, brick));
    if (!number) return fail(number);
    blocks_[level].push_back(*number);
    return {};
  }

  /// The blocks of the bricks that a brick stands for, i fastest.
  [[nodiscard]] std::vector<uint32_t> children_of(uint32_t level, const glm::u32vec3& brick) const {
    std::vector<uint32_t> children;
    if (level == 0) return children;
    const glm::u32vec3 below = volume::level_bricks(size_, level - 1);
    const glm::u32vec3 first = 2U * brick;
    const glm::u32vec3 end = glm::min(first + 2U, below);
    for (uint32_t k = first.z; k < end.z; ++k) {
      for (uint32_t j = first.y; j < end.y; ++j) {
        for (uint32_t i = first.x; i < end.x; ++i) {
          children.push_back(blocks_[level - 1][(size_t{k} * below.y + j) * below.x + i]);
        }
      }
    }
    return children;
  }

  GridInput& input_;
  const uint32_t number_;
  const glm::u32vec3 size_;
  const surfel::Grid lattice_;
  model::ModelWriter& writer_;
  volume::Pyramid<Sample> pyramid_;
  std::vector<std::vector<uint32_t>> blocks_;  ///< of the bricks of each level, in the order of the file
};

}  // namespace

double volume_bytes(const GridInput& input) {
  const glm::u32vec3 size = input.volume().size;
  double bricks = 0;
  for (uint32_t level = 0; level < volume::level_count(size); ++level) {
    const glm::u32vec3 count = volume::level_bricks(size, level);
    bricks += static_cast<double>(count.x) * count.y * count.z;
  }
  const double window =
      input.needs_doubles() ? volume::Pyramid<double>::bytes_for(size) : volume::Pyramid<float>::bytes_for(size);
  return window + bricks * kBytesPerBrick;
}

Status write_volume(GridInput& input, uint32_t number, model::ModelWriter& writer, StageClock& clock) {
  if (input.needs_doubles()) return VolumePass<double>(input, number, writer).run(clock);
  return VolumePass<float>(input, number, writer).run(clock);
}

}  // namespace surfcast::builder
