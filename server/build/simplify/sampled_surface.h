#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "simplify/point_tree.h"
#include "simplify/quadric_fit.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::simplify {

/// Memory of a search.
struct Scratch {
  std::vector<Near> near;
  std::vector<Sample> samples;
};

/// The samples of a cloud that lie on surfaces. The cloud must outlive it.
class SampledSurface {
 public:
  explicit SampledSurface(const surfel::SurfelCloud& cloud);
  SampledSurface(const SampledSurface&) = delete;
  SampledSurface& operator=(const SampledSurface&) = delete;

  [[nodiscard]] size_t size() const { return rows_.size(); }
  [[nodiscard]] uint32_t row(uint32_t sample) const { return rows_[sample]; }
  [[nodiscard]] const glm::dvec3& position(uint32_t sample) const { return positions_[sample]; }
  [[nodiscard]] glm::dvec3 normal(uint32_t sample) const { return cloud_.normals[rows_[sample]]; }
  [[nodiscard]] double radius(uint32_t sample) const { return cloud_.radii[rows_[sample]]; }
  [[nodiscard]] bool oriented() const { return cloud_.oriented; }

  /// The samples of the sheet of `normal` within a ball, or one in `stride` of them.
  void sheet(const glm::dvec3& centre, const glm::dvec3& normal, double reach, std::vector<Near>& near,
             uint32_t stride = 1) const;
  /// Replaces the samples of `scratch` by those that are near.
  void load_samples(Scratch& scratch) const;

 private:
  [[nodiscard]] bool same_sheet(const glm::dvec3& a, const glm::dvec3& b) const;

  const surfel::SurfelCloud& cloud_;
  std::vector<uint32_t> rows_;
  std::vector<glm::dvec3> positions_;
  std::optional<PointTree> tree_;
};

}  // namespace surfcast::simplify
