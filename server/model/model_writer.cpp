#include "model/model_writer.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_pipeline.h>

#include "base/atomic_file.h"
#include "base/contract.h"
#include "ldc/partition.h"
#include "model/block_encoder.h"
#include "model/format.h"

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
  if (cloud.scalars.size() > kMaxScalars) return fail(ErrorKind::kLimit, "more attributes than a model holds");
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

/// Index of a grid in the table, added when it is new.
uint32_t index_of(const Grid& grid, std::vector<Grid>& grids) {
  const auto found = std::find(grids.begin(), grids.end(), grid);
  const auto index = static_cast<uint32_t>(found - grids.begin());
  if (found == grids.end()) grids.push_back(grid);
  return index;
}

Directory start_directory(const SurfelCloud& cloud) {
  Directory directory;
  for (const SourceRange& source : cloud.sources) directory.source_names.push_back(source.name);
  for (const ScalarAttribute& scalar : cloud.scalars) {
    directory.scalar_names.push_back(scalar.name);
    directory.scalar_types.push_back(static_cast<ScalarType>(scalar.values.index()));
  }
  return directory;
}

BlockRecord make_record(const BlockPlan& plan, const EncodedBlock& block, uint64_t offset) {
  BlockRecord record;
  record.key = plan.key;
  record.origin = block.origin;
  record.extent = block.extent;
  record.surfels = block.surfels;
  record.spacing = block.spacing;
  record.max_radius = block.max_radius;
  record.normals = block.normals;
  record.offset = offset;
  record.bytes = static_cast<uint32_t>(block.bytes.size());
  record.checksum = checksum_of(block.bytes);
  return record;
}

/// Encodes on all threads, appends in the order of the plan: the file does not depend on who finished first.
Status append_blocks(const SurfelCloud& cloud, const Partition& partition, const WriteOptions& options,
                     AtomicFile& file, Directory& directory) {
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
    const BlockPlan& plan = partition.blocks[index];
    BlockRecord record = make_record(plan, block, file.position());
    record.grid = index_of(plan.grid, directory.grids);
    directory.blocks.push_back(record);
    if (status) status = file.append(block.bytes);
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

ModelHeader make_header(const SurfelCloud& cloud, std::span<const std::byte> tables, uint64_t offset) {
  ModelHeader header;
  header.oriented = cloud.oriented;
  header.z_up = cloud.z_up;
  header.color_bits = cloud.colors ? cloud.colors->bits : 0;
  header.file_bytes = offset + tables.size();
  header.directory_offset = offset;
  header.directory_bytes = tables.size();
  header.directory_checksum = checksum_of(tables);
  return header;
}

}  // namespace

Result<WriteReport> write_model(const SurfelCloud& cloud, const std::filesystem::path& target,
                                const WriteOptions& options) {
  if (const Status status = check(cloud, options); !status) {
    return fail(status.error().kind, target.string() + ": " + status.error().message);
  }
  Result<AtomicFile> file = AtomicFile::create(target);
  if (!file) return fail(std::move(file.error()));
  if (Status status = file->append(write_header({})); !status) return fail(std::move(status.error()));

  PartitionOptions partition_options;
  partition_options.precision = options.precision;
  const Partition partition = partition_cloud(cloud, partition_options);
  Directory directory = start_directory(cloud);
  if (Status status = append_blocks(cloud, partition, options, *file, directory); !status) {
    return fail(std::move(status.error()));
  }
  const std::vector<std::byte> tables = write_directory(directory);
  const std::vector<std::byte> header = write_header(make_header(cloud, tables, file->position()));
  Status status = file->append(tables);
  if (status) status = file->overwrite(0, header);
  if (status) status = file->commit();
  if (!status) return fail(std::move(status.error()));
  return WriteReport{cloud.size(), partition.blocks.size(), file->position()};
}

}  // namespace surfcast
