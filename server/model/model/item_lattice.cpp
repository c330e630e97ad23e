#include "model/item_lattice.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "ldc/lattice.h"

namespace surfcast::model {
namespace {

constexpr double kMinTolerance = 1e-30;  // keeps spacings above 0 in single precision
constexpr size_t kFinerShare = 50;       // one item in so many may be finer than the lattice

bool fits(const surfel::Grid& grid, const geometry::Box& box) {
  const glm::i64vec3 extent = grid.index(box.max) - grid.index(box.min);
  return std::max({extent.x, extent.y, extent.z}) < (int64_t{1} << kItemIndexBits);
}

}  // namespace

double item_tolerance(std::vector<double> sizes, double share) {
  const auto least = sizes.begin() + static_cast<ptrdiff_t>(sizes.size() / kFinerShare);
  std::nth_element(sizes.begin(), least, sizes.end());
  return std::max(*least / share, kMinTolerance);
}

surfel::Grid item_lattice(std::span<const glm::dvec3> positions, double tolerance) {
  geometry::Box box;
  for (const glm::dvec3& position : positions) box.include(position);
  const glm::dvec3 size = box.max - box.min;
  const double coarse = std::max({size.x, size.y, size.z}) / (int64_t{1} << kItemIndexBits);
  surfel::Grid grid = ldc::choose_lattice(box, std::max(tolerance, coarse / 2));
  while (!fits(grid, box)) grid.scale *= 2;
  return grid;
}

std::vector<glm::ivec3> item_indices(std::span<const glm::dvec3> positions, EncodedBlock& block) {
  glm::i64vec3 lowest = block.grid.index(positions.front());
  glm::i64vec3 highest = lowest;
  for (const glm::dvec3& position : positions) {
    lowest = glm::min(lowest, block.grid.index(position));
    highest = glm::max(highest, block.grid.index(position));
  }
  block.origin = lowest;
  block.extent = glm::u32vec3(highest - lowest);
  std::vector<glm::ivec3> indices;
  indices.reserve(positions.size());
  for (const glm::dvec3& position : positions) indices.emplace_back(block.grid.index(position) - lowest);
  return indices;
}

double step_along(std::span<const glm::ivec3> indices, std::span<const uint32_t> path, double lattice) {
  std::vector<double> steps{1};
  for (size_t i = 1; i < path.size(); ++i) {
    steps.push_back(glm::distance(glm::dvec3(indices[path[i]]), glm::dvec3(indices[path[i - 1]])));
  }
  const auto middle = steps.begin() + static_cast<ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return std::max(1.0, *middle) * lattice;
}

bool all_at_most(const Column& column, uint64_t limit) {
  return std::ranges::all_of(column, [limit](uint64_t value) { return value <= limit; });
}

bool all_at_most(const Field& field, uint64_t limit) {
  return std::ranges::all_of(field, [limit](const Column& column) { return all_at_most(column, limit); });
}

bool within_extent(const Field& positions, const glm::u32vec3& extent) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!all_at_most(positions[static_cast<size_t>(axis)], extent[axis])) return false;
  }
  return true;
}

}  // namespace surfcast::model
