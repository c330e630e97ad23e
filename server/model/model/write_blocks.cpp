#include "model/write_blocks.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>
#include <vector>

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_pipeline.h>

#include "model/block_encoder.h"

namespace surfcast::model {
namespace {

EncodedBlock encode(const surfel::SurfelCloud& cloud, const ldc::TreeBlock& block) {
  if (!block.coarse) {
    EncodedBlock encoded = encode_block(cloud, block.members, block.grid);
    encoded.statistics = AttributeStatistics(cloud, block.members);
    return encoded;
  }
  std::vector<uint32_t> all(block.coarse->size());
  std::iota(all.begin(), all.end(), 0);
  EncodedBlock encoded = encode_block(*block.coarse, all, block.grid);
  // Where rays hit many small pieces of surface, the radii are smaller than the spacing of the rays, but there is no
  // detail finer than that spacing. Splats of scatter are smaller than their spacing.
  if (encoded.scatter > 0) encoded.max_radius = std::max(encoded.max_radius, block.ray_spacing);
  encoded.spacing = std::min(std::max(encoded.spacing, block.ray_spacing), encoded.max_radius);
  return encoded;
}

}  // namespace

Status encode_blocks(const surfel::SurfelCloud& cloud, std::span<const ldc::TreeBlock> blocks,
                     const std::function<Status(size_t number, const EncodedBlock& block)>& take) {
  namespace tbb = oneapi::tbb;
  using Encoded = std::pair<size_t, EncodedBlock>;
  size_t next = 0;
  Status status;
  std::atomic<bool> failed = false;  // the first and the last filter run concurrently
  const auto next_number = [&](tbb::flow_control& control) -> size_t {
    if (next < blocks.size() && !failed) return next++;
    control.stop();
    return 0;
  };
  const auto encode_next = [&](size_t i) -> Encoded { return {i, encode(cloud, blocks[i])}; };
  const auto hand_over = [&](const Encoded& encoded) {
    if (failed) return;
    status = take(encoded.first, encoded.second);
    failed = !status;
  };
  const auto tokens = static_cast<size_t>(tbb::info::default_concurrency()) * 4;
  tbb::parallel_pipeline(tokens, tbb::make_filter<void, size_t>(tbb::filter_mode::serial_in_order, next_number) &
                                     tbb::make_filter<size_t, Encoded>(tbb::filter_mode::parallel, encode_next) &
                                     tbb::make_filter<Encoded, void>(tbb::filter_mode::serial_in_order, hand_over));
  return status;
}

Status write_blocks(ModelWriter& writer, const surfel::SurfelCloud& cloud, std::span<const ldc::TreeBlock> blocks,
                    const std::function<void(size_t)>& progress) {
  return encode_blocks(cloud, blocks, [&](size_t i, const EncodedBlock& block) -> Status {
    const Result<uint32_t> added = writer.add(block, blocks[i].key, blocks[i].children);
    if (progress) progress(i + 1);
    return added ? Status() : fail(added);
  });
}

}  // namespace surfcast::model
