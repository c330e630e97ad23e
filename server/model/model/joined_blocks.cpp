#include "model/joined_blocks.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "ldc/reduce.h"
#include "model/block_cloud.h"
#include "model/block_encoder.h"
#include "surfel/conform_scalars.h"
#include "surfel/drawn_radius.h"
#include "surfel/normalization_weights.h"

namespace surfcast::model {
namespace {

ldc::CoarseAttributes attributes_of(const ModelInfo& info, bool oriented, std::span<const ScalarColumn> coarse) {
  ldc::CoarseAttributes attributes{oriented, info.z_up, info.color_bits, {}};
  for (const ScalarColumn& column : coarse) {
    attributes.scalars.push_back({column.name, surfel::filling(column.name, column.type, 0)});
  }
  return attributes;
}

std::vector<uint32_t> all_of(size_t count) {
  std::vector<uint32_t> all(count);
  std::iota(all.begin(), all.end(), uint32_t{0});
  return all;
}

/// The surfels of a decoded block, with the radii that are drawn.
std::vector<ldc::CoarseSurfel> coarse_surfels(DecodedBlock block, bool leaf, const ModelInfo& info) {
  const float widest =
      leaf ? surfel::largest_drawn_radius(block.radii, block.scatter) : std::numeric_limits<float>::max();
  const surfel::SurfelCloud cloud = cloud_of(std::move(block), info);
  return ldc::sample_surfels(cloud, all_of(cloud.size()), widest);
}

ldc::CoarseCell make_cell(std::span<const ldc::CoarseSurfel> below, const SharedBlock& shared) {
  if (below.empty()) return {};
  // Its level saves surfels even where it leaves most of them, because the level below has many blocks.
  constexpr double kAnyPart = 1;
  ldc::CoarseCell cell = ldc::reduce(below, shared.cube, ldc::OctreeKey(), shared.oriented, kAnyPart);
  for (ldc::CoarseSurfel& surfel : cell.surfels) surfel.radius = std::min(surfel.radius, shared.max_radius);
  return cell;
}

}  // namespace

JoinedBlocks::JoinedBlocks(std::shared_ptr<const JoinedParts> parts, const ModelInfo& info,
                           std::vector<ScalarColumn> scalars)
    : parts_(std::move(parts)),
      info_(info),
      scalars_(std::move(scalars)),
      made_(std::make_unique<Made[]>(parts_->shared.size())) {
  std::ranges::copy_if(scalars_, std::back_inserter(coarse_scalars_), &ScalarColumn::coarse);
}

/// Adds the blocks of members that a block is made of. Those of a shared block that has been made are not needed.
void JoinedBlocks::add_sources(uint32_t block, std::vector<std::vector<uint32_t>>& own) const {
  const BlockOrigin& origin = parts_->origins[block];
  if (origin.member != BlockOrigin::kShared) {
    own[origin.member].push_back(origin.index);
    return;
  }
  if (made_[origin.index].done.load(std::memory_order_acquire)) return;
  const auto [first, count] = parts_->shared[origin.index].children;
  for (uint32_t child = first; child < first + count; ++child) add_sources(child, own);
}

void JoinedBlocks::prefetch(std::span<const uint32_t> blocks) const {
  std::vector<std::vector<uint32_t>> own(parts_->members.size());
  for (const uint32_t block : blocks) add_sources(block, own);
  for (size_t i = 0; i < own.size(); ++i) {
    if (!own[i].empty()) parts_->members[i].model->prefetch(own[i]);
  }
}

void JoinedBlocks::forget(size_t block) const {
  std::vector<std::vector<uint32_t>> own(parts_->members.size());
  add_sources(static_cast<uint32_t>(block), own);
  for (size_t i = 0; i < own.size(); ++i) {
    for (const uint32_t source : own[i]) parts_->members[i].model->forget(source);
  }
}

uint64_t JoinedBlocks::unit_of(uint32_t block) const {
  constexpr int kMemberShift = 48;  // members are few, and units of one are numbers of its blocks or nodes
  const BlockOrigin& origin = parts_->origins[block];
  const bool shared = origin.member == BlockOrigin::kShared;
  const uint64_t own = shared ? block : parts_->members[origin.member].model->unit_of(origin.index);
  const uint64_t member = shared ? parts_->members.size() : origin.member;
  return member << kMemberShift | own;
}

Result<StoredBlock> JoinedBlocks::stored(size_t block) const {
  const BlockOrigin& origin = parts_->origins[block];
  if (origin.member == BlockOrigin::kShared) {
    return fail(ErrorKind::kUnsupported, "stands for blocks of several models: it has no bytes");
  }
  return parts_->members[origin.member].model->stored(origin.index);
}

Result<DecodedBlock> JoinedBlocks::decode(size_t block, WantedScalars scalars) const {
  const BlockOrigin& origin = parts_->origins[block];
  if (origin.member == BlockOrigin::kShared) return decode_shared(origin.index, scalars);
  return decode_own(origin, scalars);
}

Result<DecodedBlock> JoinedBlocks::decode_own(const BlockOrigin& origin, WantedScalars scalars) const {
  const Member& member = parts_->members[origin.member];
  Result<DecodedBlock> decoded = member.model->decode(origin.index, scalars);
  if (!decoded) return decoded;
  if (!member.places.empty()) decoded = placed(std::move(*decoded), member.places[origin.index]);
  const bool leaf = member.model->blocks()[origin.index].level == 0;
  const std::span<const ScalarColumn> columns = leaf ? scalars_ : coarse_scalars_;
  return conform(std::move(*decoded), member.model->info().color_bits, info_.color_bits,
                 columns.first(count_of(scalars, columns)), scalars);
}

Result<DecodedBlock> JoinedBlocks::decode_shared(uint32_t shared, WantedScalars scalars) const {
  const Result<std::shared_ptr<const ldc::CoarseCell>> cell = cell_of(shared);
  if (!cell) return fail(cell);
  if ((**cell).surfels.empty()) return DecodedBlock();
  const ldc::CoarseAttributes attributes = attributes_of(info_, parts_->shared[shared].oriented, coarse_scalars_);
  surfel::SurfelCloud cloud = ldc::make_coarse_cloud((**cell).surfels, attributes);
  cloud.weights = surfel::normalization_weights(cloud);
  DecodedBlock block = quantize_block(cloud, all_of(cloud.size()), (**cell).grid);
  block.scalars.resize(count_of(scalars, coarse_scalars_));
  return block;
}

Result<std::shared_ptr<const ldc::CoarseCell>> JoinedBlocks::cell_of(uint32_t shared) const {
  Made& made = made_[shared];
  const std::lock_guard lock(made.mutex);
  if (made.cell) return made.cell;
  const Result<std::vector<ldc::CoarseSurfel>> below = surfels_below(shared);
  if (!below) return fail(below);
  made.cell = std::make_shared<const ldc::CoarseCell>(make_cell(*below, parts_->shared[shared]));
  made.done.store(true, std::memory_order_release);
  return made.cell;
}

/// The surfels of all children. A thread that waits for others takes no work from elsewhere, which might wait for the
/// block that this one makes.
Result<std::vector<ldc::CoarseSurfel>> JoinedBlocks::surfels_below(uint32_t shared) const {
  const auto [first, count] = parts_->shared[shared].children;
  std::vector<Result<std::vector<ldc::CoarseSurfel>>> children(count);
  oneapi::tbb::this_task_arena::isolate([&, first = first, count = count] {
    oneapi::tbb::parallel_for(uint32_t{0}, count, [&](uint32_t i) { children[i] = surfels_of(first + i); });
  });
  std::vector<ldc::CoarseSurfel> all;
  for (const Result<std::vector<ldc::CoarseSurfel>>& child : children) {
    if (!child) return fail(child);
    all.insert(all.end(), child->begin(), child->end());
  }
  return all;
}

Result<std::vector<ldc::CoarseSurfel>> JoinedBlocks::surfels_of(uint32_t block) const {
  const BlockOrigin& origin = parts_->origins[block];
  if (origin.member == BlockOrigin::kShared) {
    return cell_of(origin.index).map([](const auto& cell) { return cell->surfels; });
  }
  const bool leaf = parts_->members[origin.member].model->blocks()[origin.index].level == 0;
  return decode_own(origin, WantedScalars::kDrawn).map([&](DecodedBlock&& own) {
    return coarse_surfels(std::move(own), leaf, info_);
  });
}

Result<Georeference> JoinedBlocks::georeference() const {
  Georeference joined;
  for (const Member& member : parts_->members) {
    Result<Georeference> own = member.model->georeference();
    if (!own) return own;
    if (!own->known()) continue;
    if (!joined.known()) {
      joined = std::move(*own);
    } else if (own->source != joined.source) {
      joined.source = {};
    }
  }
  return joined;
}

}  // namespace surfcast::model
