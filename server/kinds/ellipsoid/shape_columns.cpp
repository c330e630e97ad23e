#include "ellipsoid/shape_columns.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

namespace surfcast::ellipsoid {
namespace {

constexpr size_t kGrain = 1024;

glm::u32vec3 index_of(const TensorSample& sample) {
  return sample.index;
}

glm::u32vec3 index_of(const AxesSample& /*sample*/) {
  return glm::u32vec3(0);
}

template <typename Sample>
ShapeColumns columns_of(std::span<const Sample> samples, model::EllipsoidCounts& counts) {
  std::vector<Shape> shapes(samples.size());
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<size_t>(0, samples.size(), kGrain), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) shapes[i] = shape_of(samples[i]);
  });
  ShapeColumns columns;
  Ellipsoids& drawn = columns.ellipsoids;
  for (uint32_t i = 0; i < samples.size(); ++i) {
    count(shapes[i].verdict, counts);
    if (shapes[i].verdict != Verdict::kDrawn) continue;
    columns.rows.push_back(i);
    drawn.positions.push_back(samples[i].position);
    drawn.values.push_back(shapes[i].values);
    drawn.rotations.push_back(shapes[i].rotation);
    drawn.samples.push_back(index_of(samples[i]));
  }
  drawn.counts.assign(drawn.size(), 1.0F);
  drawn.factors.assign(drawn.size(), 1.0F);
  return columns;
}

}  // namespace

ShapeColumns shapes_of(std::span<const TensorSample> samples, model::EllipsoidCounts& counts) {
  return columns_of(samples, counts);
}

ShapeColumns shapes_of(std::span<const AxesSample> samples, model::EllipsoidCounts& counts) {
  return columns_of(samples, counts);
}

}  // namespace surfcast::ellipsoid
