#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace surfcast::exporter {

/// Points of an even sample are at least this part of the side of their cube apart.
inline constexpr double kSampleSpacing = 1.0 / 128;

/// A point of a cube.
struct SamplePoint {
  glm::vec3 place{0};  ///< each coordinate from 0 to 1
  uint64_t hash = 0;   ///< the same in whatever order points come; the least is tried first
};

/// The numbers of the points that make an even sample, in ascending order: no two of them are closer together than
/// kSampleSpacing, and all others are closer than that to one of them (a Poisson disk sample). It is random, so it has
/// no lattice, and does not depend on the order of the points.
std::vector<uint32_t> even_sample(std::span<const SamplePoint> points);

}  // namespace surfcast::exporter
