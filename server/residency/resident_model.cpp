#include "residency/resident_model.h"

#include <algorithm>
#include <optional>
#include <span>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "residency/packing.h"

namespace surfcast {
namespace {

constexpr uint32_t kArenaSurfels = 4u << 20;  // 64 MiB of geometry: half of the smallest limit met

/// Blocks [first, last) that share an arena.
struct ArenaPlan {
  size_t first = 0;
  size_t last = 0;
  uint32_t surfels = 0;
};

std::vector<ArenaPlan> plan_arenas(std::span<const BlockEntry> blocks) {
  std::vector<ArenaPlan> plans;
  for (size_t i = 0; i < blocks.size(); ++i) {
    if (plans.empty() || plans.back().surfels + blocks[i].surfels > kArenaSurfels) plans.push_back({i, i, 0});
    plans.back().last = i + 1;
    plans.back().surfels += blocks[i].surfels;
  }
  return plans;
}

Result<std::vector<PackedBlock>> decode_blocks(const ModelFile& model, const ArenaPlan& plan) {
  std::vector<PackedBlock> packed(plan.last - plan.first);
  std::vector<std::optional<Error>> errors(packed.size());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, packed.size(), 1), [&](const tbb::blocked_range<size_t>& range) {
    for (size_t i = range.begin(); i != range.end(); ++i) {
      Result<DecodedBlock> block = model.decode(plan.first + i);
      if (block) {
        packed[i] = pack_block(*block, model.info().color_bits);
      } else {
        errors[i] = std::move(block.error());
      }
    }
  });
  for (std::optional<Error>& error : errors) {
    if (error) return fail(std::move(*error));
  }
  return packed;
}

template <typename T>
void upload(const gl::Buffer& buffer, size_t first, const std::vector<T>& values) {
  glNamedBufferSubData(buffer.name(), static_cast<GLintptr>(first * sizeof(T)),
                       static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data());
}

Arena make_arena(uint32_t surfels, bool colored) {
  Arena arena;
  arena.surfels = surfels;
  arena.geometry = gl::make_buffer("geometry", size_t{surfels} * sizeof(glm::uvec4), GL_DYNAMIC_STORAGE_BIT);
  arena.size_and_weight = gl::make_buffer("size and weight", size_t{surfels} * 4, GL_DYNAMIC_STORAGE_BIT);
  if (colored) arena.colors = gl::make_buffer("color", size_t{surfels} * 4, GL_DYNAMIC_STORAGE_BIT);
  return arena;
}

}  // namespace

Result<ResidentModel> ResidentModel::load(const ModelFile& model) {
  ResidentModel resident;
  const bool colored = model.info().color_bits > 0;
  for (const ArenaPlan& plan : plan_arenas(model.blocks())) {
    Result<std::vector<PackedBlock>> packed = decode_blocks(model, plan);
    if (!packed) return fail(std::move(packed.error()));
    const Arena& arena = resident.arenas_.emplace_back(make_arena(plan.surfels, colored));
    uint32_t first = 0;
    for (const PackedBlock& block : *packed) {
      const auto surfels = static_cast<uint32_t>(block.geometry.size());
      upload(arena.geometry, first, block.geometry);
      upload(arena.size_and_weight, first, block.size_and_weight);
      if (colored) upload(arena.colors, first, block.colors);
      resident.blocks_.push_back({block.origin, block.radius_unit, resident.arenas_.size() - 1, first, surfels});
      first += surfels;
    }
    resident.gpu_bytes_ += size_t{plan.surfels} * (colored ? 24 : 20);
  }
  return resident;
}

}  // namespace surfcast
