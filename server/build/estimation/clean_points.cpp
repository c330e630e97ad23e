#include "estimation/clean_points.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <tuple>

#include <tbb/parallel_for.h>

#include "base/hash.h"
#include "estimation/first_equals.h"
#include "geometry/finite.h"
#include "scan/unit_normal.h"

namespace surfcast::estimation {
namespace {

using Keep = std::vector<bool>;

template <typename T>
void compact(std::vector<T>& values, const Keep& keep) {
  if (values.empty()) return;
  size_t kept = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    if (keep[i]) values[kept++] = values[i];
  }
  values.resize(kept);
}

/// Works on points and clouds, which name their attributes alike.
template <typename Points>
void compact_attributes(Points& points, const Keep& keep) {
  compact(points.positions, keep);
  compact(points.normals, keep);
  compact(points.radii, keep);
  if (points.colors) compact(points.colors->values, keep);
  for (surfel::ScalarAttribute& scalar : points.scalars) {
    std::visit([&keep](auto& values) { compact(values, keep); }, scalar.values);
  }
}

// ---- duplicates

/// The values of one attribute as bytes; value i starts at `first + i * stride`.
struct Bytes {
  const std::byte* first;
  size_t stride;
};

template <typename T>
void add_bytes(std::vector<Bytes>& all, const std::vector<T>& values) {
  if (!values.empty()) all.push_back({reinterpret_cast<const std::byte*>(values.data()), sizeof(T)});
}

std::vector<Bytes> all_bytes(const surfel::SurfelCloud& cloud) {
  std::vector<Bytes> all;
  add_bytes(all, cloud.positions);
  add_bytes(all, cloud.normals);
  add_bytes(all, cloud.radii);
  if (cloud.colors) add_bytes(all, cloud.colors->values);
  for (const surfel::ScalarAttribute& scalar : cloud.scalars) {
    std::visit([&all](const auto& values) { add_bytes(all, values); }, scalar.values);
  }
  return all;
}

std::vector<uint64_t> hash_surfels(const std::vector<Bytes>& all, size_t count) {
  std::vector<uint64_t> hashes(count);
  tbb::parallel_for(size_t{0}, count, [&](size_t i) {
    uint64_t hash = 0;
    for (const auto& [first, stride] : all) hash = hash_of({first + i * stride, stride}, hash);
    hashes[i] = hash;
  });
  return hashes;
}

void shrink_sources(std::vector<surfel::SourceRange>& sources, const Keep& keep) {
  size_t first = 0;
  for (surfel::SourceRange& source : sources) {
    const auto begin = keep.begin() + static_cast<std::ptrdiff_t>(source.first);
    source.count = static_cast<size_t>(std::count(begin, begin + static_cast<std::ptrdiff_t>(source.count), true));
    source.first = first;
    first += source.count;
  }
}

}  // namespace

void drop_unusable_points(scan::ScanPoints& points, SurfelReport& report) {
  for (glm::vec3& normal : points.normals) normal = scan::unit_or_zero(normal);
  Keep keep(points.size(), true);
  uint64_t dropped = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    points.positions[i] += 0.0;  // turns -0 into +0, which is the same position
    if (!geometry::finite(points.positions[i])) {
      ++report.not_finite;
    } else if (!points.normals.empty() && points.normals[i] == glm::vec3(0)) {
      ++report.zero_normals;
    } else {
      continue;
    }
    keep[i] = false;
    ++dropped;
  }
  if (dropped > 0) compact_attributes(points, keep);
}

std::vector<bool> find_duplicates(const surfel::SurfelCloud& cloud) {
  const std::vector<Bytes> all = all_bytes(cloud);
  const std::vector<uint64_t> hashes = hash_surfels(all, cloud.size());
  const std::vector<uint32_t> first = first_equals(hashes, [&all](size_t a, size_t b) {
    return std::all_of(all.begin(), all.end(), [a, b](const Bytes& bytes) {
      return std::memcmp(bytes.first + a * bytes.stride, bytes.first + b * bytes.stride, bytes.stride) == 0;
    });
  });
  std::vector<bool> duplicate(cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) duplicate[i] = first[i] != i;
  return duplicate;
}

void keep_surfels(surfel::SurfelCloud& cloud, const std::vector<bool>& keep) {
  if (std::find(keep.begin(), keep.end(), false) == keep.end()) return;
  shrink_sources(cloud.sources, keep);
  compact(cloud.weights, keep);
  compact(cloud.scatter, keep);
  compact_attributes(cloud, keep);
}

}  // namespace surfcast::estimation
