#include "builder/spatial_order.h"

#include <algorithm>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include "builder/cloud_columns.h"

namespace surfcast::builder {
namespace {

/// A Morton code and the index of its point.
using Place = std::pair<uint64_t, uint32_t>;

std::vector<Place> sorted_places(const surfel::SurfelCloud& cloud, const surfel::SourceRange& source,
                                 const geometry::RootCube& root) {
  std::vector<Place> places(source.count);
  oneapi::tbb::parallel_for(size_t{0}, places.size(), [&](size_t i) {
    const size_t point = source.first + i;
    places[i] = {geometry::morton_code(root, cloud.positions[point]), static_cast<uint32_t>(point)};
  });
  oneapi::tbb::parallel_sort(places.begin(), places.end());
  return places;
}

bool share_a_cell(const std::vector<Place>& places) {
  const auto same = [](const Place& a, const Place& b) { return a.first == b.first; };
  return std::adjacent_find(places.begin(), places.end(), same) != places.end();
}

}  // namespace

SpatialOrder spatial_order(const PartPoints& points, const geometry::RootCube& root) {
  const std::vector<size_t>& inputs = points.inputs;
  SpatialOrder order;
  order.distinct = std::adjacent_find(inputs.begin(), inputs.end(), std::not_equal_to<>()) == inputs.end();
  order.points.resize(points.cloud.size());
  for (const surfel::SourceRange& source : points.cloud.sources) {
    const std::vector<Place> places = sorted_places(points.cloud, source, root);
    oneapi::tbb::parallel_for(size_t{0}, places.size(),
                              [&](size_t i) { order.points[source.first + i] = places[i].second; });
    order.distinct = order.distinct && !share_a_cell(places);
  }
  return order;
}

void reorder(surfel::SurfelCloud& cloud, std::span<const uint32_t> order) {
  for_each_column(cloud, [&](auto& values) {
    std::decay_t<decltype(values)> sorted(values.size());
    oneapi::tbb::parallel_for(size_t{0}, sorted.size(), [&](size_t i) { sorted[i] = values[order[i]]; });
    values.swap(sorted);
  });
}

}  // namespace surfcast::builder
