#include "model/write_model.h"

#include <cmath>
#include <utility>

#include "base/contract.h"
#include "ldc/subtree.h"
#include "model/write_blocks.h"

namespace surfcast::model {
namespace {

bool storable(float value) {
  return std::isfinite(value) && value > 0;
}

bool storable(const glm::dvec3& p) {
  // Far beyond the coordinates of any scan, and small enough that box sizes and their squares stay finite.
  constexpr double kLimit = 1e150;
  return std::abs(p.x) < kLimit && std::abs(p.y) < kLimit && std::abs(p.z) < kLimit;
}

bool storable(const glm::vec3& normal) {
  const float square = normal.x * normal.x + normal.y * normal.y + normal.z * normal.z;
  return square > 0.5f && square < 2.0f;
}

void expect_one_length(const surfel::SurfelCloud& cloud) {
  const size_t n = cloud.size();
  SURFCAST_EXPECTS(cloud.normals.size() == n && cloud.radii.size() == n && cloud.weights.size() == n);
  SURFCAST_EXPECTS(!cloud.colors || cloud.colors->values.size() == n);
  SURFCAST_EXPECTS(cloud.scatter.empty() || cloud.scatter.size() == n);
  for (const surfel::ScalarAttribute& scalar : cloud.scalars) SURFCAST_EXPECTS(surfel::value_count(scalar.values) == n);
}

Status check(const surfel::SurfelCloud& cloud, const WriteOptions& options) {
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

}  // namespace

Result<WriteReport> write_model(const surfel::SurfelCloud& cloud, const std::filesystem::path& target,
                                const WriteOptions& options) {
  if (const Status status = check(cloud, options); !status) {
    return fail_about(target.string(), status);
  }
  Result<ModelWriter> writer = ModelWriter::create(target, schema_of(cloud));
  if (!writer) return fail(writer);
  ldc::PartitionOptions partition;
  partition.precision = options.precision;
  const ldc::Subtree tree = ldc::build_subtree(cloud, ldc::whole_region(cloud), partition, 0);
  const auto progress = [&](size_t done) {
    if (options.progress) options.progress(static_cast<double>(done) / static_cast<double>(tree.blocks.size()));
  };
  if (Status status = write_blocks(*writer, cloud, tree.blocks, progress); !status) {
    return fail(status);
  }
  return writer->finish();
}

}  // namespace surfcast::model
