#include "exporter/record_places.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include <oneapi/tbb/parallel_for.h>

#include "scan/scalar_type.h"

namespace surfcast::exporter {
namespace {

// Offsets in the public header block: LAS 1.4 specification, table 3.
constexpr size_t kScaleAt = 131;
constexpr size_t kOffsetAt = 155;

glm::dvec3 vector_at(const LasHead& head, size_t offset) {
  glm::dvec3 vector;
  for (int axis = 0; axis < 3; ++axis)
    vector[axis] = scan::load<double>(&head.header[offset + 8 * static_cast<size_t>(axis)]);
  return vector;
}

}  // namespace

geometry::RootCube cube_of(const LasHead& head, const LasCounts& counts) {
  const glm::dvec3 scale = vector_at(head, kScaleAt), offset = vector_at(head, kOffsetAt), steps = glm::abs(scale);
  const glm::dvec3 a = glm::dvec3(counts.low[0], counts.low[1], counts.low[2]) * scale + offset;
  const glm::dvec3 b = glm::dvec3(counts.high[0], counts.high[1], counts.high[2]) * scale + offset;
  const glm::dvec3 low = glm::min(a, b), size = glm::max(a, b) - low;
  // A step wider than the points, so that none lies on an upper face.
  return {low, std::max({size.x + steps.x, size.y + steps.y, size.z + steps.z})};
}

RecordPlaces::RecordPlaces(const LasHead& head, const geometry::RootCube& cube)
    : record_bytes_(head.record_length),
      scale_(vector_at(head, kScaleAt)),
      offset_(vector_at(head, kOffsetAt)),
      cube_(cube) {}

glm::dvec3 RecordPlaces::position(const std::byte* record) const {
  const glm::dvec3 index(scan::load<int32_t>(record), scan::load<int32_t>(record + 4), scan::load<int32_t>(record + 8));
  return index * scale_ + offset_;
}

std::vector<uint64_t> RecordPlaces::codes(std::span<const std::byte> records) const {
  std::vector<uint64_t> codes(records.size() / record_bytes_);
  oneapi::tbb::parallel_for(size_t{0}, codes.size(), [&](size_t i) {
    codes[i] = geometry::morton_code(cube_, position(&records[i * record_bytes_]));
  });
  return codes;
}

glm::vec3 RecordPlaces::place_in(const ldc::OctreeKey& cell, const std::byte* record) const {
  const double side = std::ldexp(cube_.side, -cell.depth);
  const glm::dvec3 low = cube_.min + side * glm::dvec3(cell.x, cell.y, cell.z);
  return glm::vec3((position(record) - low) / side);
}

}  // namespace surfcast::exporter
