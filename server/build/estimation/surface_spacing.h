#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "estimation/neighbours.h"
#include "estimation/sites.h"
#include "geometry/box.h"

namespace surfcast::estimation {

/// A site on a surface.
struct SurfaceSample {
  glm::dvec3 position{0};  ///< local, as in Sites
  float radius = 0;        ///< as estimated, world units
};

/// One in this many surface points of a cloud is a sample: eight in general, more in very large clouds, so that the
/// samples of the whole cloud fit into memory.
uint64_t points_per_sample(uint64_t points);

/// True if a site is to be a sample, provided that it lies on a surface. Decided by a hash of its position, so it
/// depends neither on the order of the points nor on the part. Strays are not sampled: sites that fewer than two of
/// their six nearest count among their own neighbours.
bool is_sampled(const Sites& sites, const NeighbourGraph& graph, uint32_t site, uint64_t per_sample);

/// The radius of the surfaces around a place: the median of the radii of the eight nearest samples, which stand for 64
/// points; of equally near ones, those that come first in Morton order. The samples are those of a whole cloud, so the
/// result does not depend on how the cloud is cut into parts.
class SurfaceSpacing {
 public:
  /// `bounds` are those of the whole cloud. The order of the samples does not affect the result.
  SurfaceSpacing(std::vector<SurfaceSample> samples, const geometry::Box& bounds);

  SurfaceSpacing(SurfaceSpacing&&) noexcept;
  SurfaceSpacing& operator=(SurfaceSpacing&&) noexcept;
  ~SurfaceSpacing();

  /// World units; infinite without samples. Thread-safe.
  [[nodiscard]] double at(const glm::dvec3& position) const;

  /// True if it is enough to know that the spacing at place number i is at least `least`.
  using Enough = std::function<bool(size_t i, double least)>;

  /// The same for many places, on all threads. Where `enough` says so, a smaller number that is enough. Fast where
  /// places that follow each other are near each other.
  [[nodiscard]] std::vector<float> at_all(std::span<const glm::dvec3> positions, const Enough& enough) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace surfcast::estimation
