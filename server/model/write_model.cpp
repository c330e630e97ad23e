#include "model/write_model.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_pipeline.h>

#include "base/contract.h"
#include "ldc/partition.h"
#include "model/block_encoder.h"

namespace surfcast {
namespace {

bool storable(float value) {
  return std::isfinite(value) && value > 0;
}

bool storable(const glm::dvec3& p) {
  // Far beyond any scan, and small enough that box sizes and squares stay finite.
  constexpr double kLimit = 1e150;
  return std::abs(p.x) < kLimit && std::abs(p.y) < kLimit && std::abs(p.z) < kLimit;
}

bool storable(const glm::vec3& normal) {
  const float square = normal.x * normal.x + normal.y * normal.y + normal.z * normal.z;
  return square > 0.5f && square < 2.0f;
}

void expect_one_length(const SurfelCloud& cloud) {
  const size_t n = cloud.size();
  SURFCAST_EXPECTS(cloud.normals.size() == n && cloud.radii.size() == n && cloud.weights.size() == n);
  SURFCAST_EXPECTS(!cloud.colors || cloud.colors->values.size() == n);
  for (const ScalarAttribute& scalar : cloud.scalars) SURFCAST_EXPECTS(value_count(scalar.values) == n);
}

Status check(const SurfelCloud& cloud, const WriteOptions& options) {
  expect_one_length(cloud);
  const auto refuse = [](size_t surfel, const char* what) {
    return fail(ErrorKind::kInvalidInput, "surfel " + std::to_string(surfel) + " has " + what);
  };
  if (cloud.size() == 0) return fail(ErrorKind::kInvalidInput, "no surfels to write");
  if (options.precision && !storable(static_cast<float>(*options.precision))) {
    return fail(ErrorKind::kInvalidInput, "the precision must be positive");
  }
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (!storable(cloud.positions[i])) return refuse(i, "a position that cannot be stored");
    if (!storable(cloud.normals[i])) return refuse(i, "a normal that is not unit");
    if (!storable(cloud.radii[i])) return refuse(i, "a radius that is not positive");
    if (!storable(cloud.weights[i])) return refuse(i, "a weight that is not positive");
  }
  return {};
}

/// Encodes on all threads, appends in the order of the plan: the file does not depend on who finished first.
Status append_blocks(const SurfelCloud& cloud, const Partition& partition, const WriteOptions& options,
                     ModelWriter& writer) {
  namespace tbb = oneapi::tbb;
  using Encoded = std::pair<size_t, EncodedBlock>;
  size_t next = 0;
  size_t written = 0;
  Status status;
  std::atomic<bool> failed = false;  // the first filter and the last one run at the same time
  const auto take = [&](tbb::flow_control& control) -> size_t {
    if (next < partition.blocks.size() && !failed) return next++;
    control.stop();
    return 0;
  };
  const auto encode = [&](size_t index) -> Encoded {
    const BlockPlan& plan = partition.blocks[index];
    const std::span members = std::span(partition.order).subspan(plan.first, plan.count);
    return {index, encode_block(cloud, members, plan.grid)};
  };
  const auto append = [&](const Encoded& encoded) {
    const auto& [index, block] = encoded;
    if (!status) return;
    if (Result<uint32_t> added = writer.add(block, partition.blocks[index].key, {}); !added)
      status = fail(std::move(added.error()));
    failed = !status.has_value();
    if (options.progress)
      options.progress(static_cast<double>(++written) / static_cast<double>(partition.blocks.size()));
  };
  const auto tokens = static_cast<size_t>(tbb::info::default_concurrency()) * 4;
  tbb::parallel_pipeline(tokens, tbb::make_filter<void, size_t>(tbb::filter_mode::serial_in_order, take) &
                                     tbb::make_filter<size_t, Encoded>(tbb::filter_mode::parallel, encode) &
                                     tbb::make_filter<Encoded, void>(tbb::filter_mode::serial_in_order, append));
  return status;
}

}  // namespace

Result<WriteReport> write_model(const SurfelCloud& cloud, const std::filesystem::path& target,
                                const WriteOptions& options) {
  if (const Status status = check(cloud, options); !status) {
    return fail(status.error().kind, target.string() + ": " + status.error().message);
  }
  Result<ModelWriter> writer = ModelWriter::create(target, schema_of(cloud));
  if (!writer) return fail(std::move(writer.error()));
  PartitionOptions partition_options;
  partition_options.precision = options.precision;
  const Partition partition = partition_cloud(cloud, partition_options);
  if (Status status = append_blocks(cloud, partition, options, *writer); !status) {
    return fail(std::move(status.error()));
  }
  return writer->finish();
}

}  // namespace surfcast
