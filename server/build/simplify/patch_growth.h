#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "simplify/sampled_surface.h"
#include "simplify/simplify.h"
#include "surfel/curvature.h"

namespace surfcast::simplify {

/// A neighbourhood that keeps the bound.
struct Patch {
  uint32_t sample = 0;  ///< at its centre
  double reach = 0;     ///< radius; 0: not even the smallest keeps the bound
  surfel::OsculatingSurface surface;
  Residual residual;
  size_t samples = 0;
  bool curved = false;
  bool pays = false;  ///< keeps the bound as a plane, or much better with curvature than without
};

/// The bound in a neighbourhood.
struct Limits {
  double angle = 0;  ///< radians
  double height = 0;
  [[nodiscard]] bool hold(const Residual& r) const { return r.angle <= angle && r.height <= height; }
};

/// What is noise around a place: the part of the residuals there that does not grow with the neighbourhood. What a
/// quadric leaves of a smooth surface grows, in angle with the square and in height with the cube of the radius.
class Noise {
 public:
  explicit Noise(const SampledSurface& surface);
  Noise(const Noise&) = delete;
  Noise& operator=(const Noise&) = delete;

  [[nodiscard]] Limits around(uint32_t sample, Scratch& scratch) const;

 private:
  [[nodiscard]] std::optional<Residual> within(uint32_t sample, double reach, Scratch& scratch) const;
  [[nodiscard]] std::optional<Limits> estimate(uint32_t sample, Scratch& scratch) const;

  const SampledSurface& surface_;
  std::vector<Limits> estimates_;
  std::vector<glm::dvec3> centres_;
  std::optional<PointTree> tree_;
};

/// Grows the neighbourhood of a sample while one surface keeps the bound, or is no farther off than noise is. Safe to
/// use from several threads at once, each with its own scratch.
class Growth {
 public:
  Growth(const SampledSurface& surface, const ErrorBound& bound) : surface_(surface), bound_(bound), noise_(surface) {}

  [[nodiscard]] Patch grow(uint32_t sample, Scratch& scratch) const;
  /// The patch that has grown, made as much smaller as all of its samples ask for, with its flags. While a patch grows,
  /// some of its samples speak for all.
  [[nodiscard]] Patch settle(const Patch& grown, Scratch& scratch) const;

 private:
  std::optional<Patch> fit(uint32_t sample, double reach, const Limits& noise, Scratch& scratch) const;
  Patch shrunk_to_bound(const Patch& patch, const Limits& noise, Scratch& scratch) const;
  void judge(Scratch& scratch, Patch& patch) const;

  const SampledSurface& surface_;
  const ErrorBound& bound_;
  Noise noise_;
};

}  // namespace surfcast::simplify
