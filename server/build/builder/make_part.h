#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "builder/build_inputs.h"
#include "builder/part_finder.h"
#include "builder/part_plan.h"
#include "builder/part_store.h"
#include "estimation/make_surfels.h"
#include "geometry/morton.h"

namespace surfcast::builder {

/// What all parts of a build share.
struct BuildFrame {
  BuildFrame(const BuildInputs& inputs, std::vector<Part> plan);
  /// Parts of a model that gets `added`; the others stay as they are. The model comes before the inputs, one entry for
  /// each lattice of `lattices`, and its surfaces are `oriented` or not.
  BuildFrame(const BuildInputs& added, std::span<const InputName> lattices, const geometry::RootCube& whole,
             const geometry::Box& all, bool oriented, std::vector<Part> plan);

  estimation::Scene scene;
  geometry::Box bounds;
  uint64_t points = 0;  ///< of all inputs
  geometry::RootCube root;
  std::vector<std::optional<glm::dvec3>> sensors;    ///< for each input
  std::vector<std::optional<double>> surface_steps;  ///< for each input, see ScanSchema
  std::vector<bool> exact_radii;                     ///< for each input, see ScanSchema
  bool two_sided = false;                            ///< of some input
  std::vector<InputName> names;
  std::vector<Part> parts;
  PartFinder finder;
  std::optional<bool> oriented{};  ///< known before; none: to be decided

 private:
  void add_inputs(const BuildInputs& inputs);
};

/// The surfels of a part, and what it tells about the scene.
struct MadePart {
  estimation::PartSurfels surfels;  ///< own ones before those of the halo
  std::vector<size_t> inputs;       ///< for each source of the cloud, the index of the input
  size_t own = 0;                   ///< surfels
  std::vector<uint32_t> order;      ///< of the points, see spatial_order.h; empty unless it is wanted
  std::vector<uint8_t> kept;        ///< for each of the sorted points, 0 if it is a duplicate
  estimation::PartSigns signs;
  estimation::SurfelReport report;
};

/// First phase: sorts the points of a part, drops duplicates and makes surfels. `want_order`: of the points.
MadePart make_part(const BuildFrame& frame, PartPoints points, size_t part, estimation::RadiusPolicy radii,
                   bool want_order);

/// What is decided for the whole scene.
struct SceneDecisions {
  estimation::ResolvedSigns signs;
  std::vector<estimation::RadiusDecision> radii;  ///< for each input
};

/// What all parts together tell about the scene.
class SceneEvidence {
 public:
  explicit SceneEvidence(size_t inputs) : comparisons_(inputs) {}

  /// Adds what the next part tells. Parts are added in their order.
  void add(estimation::PartSigns signs, std::span<const estimation::RadiusComparison> radii,
           std::span<const estimation::SurfaceSample> samples);
  /// Decides once all parts are added. Reports what was estimated.
  [[nodiscard]] SceneDecisions decide(const BuildFrame& frame, estimation::RadiusPolicy radii,
                                      estimation::SurfelReport& report) const;
  /// Samples of the surfaces of all parts.
  [[nodiscard]] std::vector<estimation::SurfaceSample> take_samples() && { return std::move(samples_); }

 private:
  std::vector<estimation::PartSigns> signs_;
  std::vector<estimation::RadiusComparison> comparisons_;  ///< for each input
  std::vector<estimation::SurfaceSample> samples_;
};

/// The surfels of a part, own ones before those of the halo.
struct FinishedPart {
  surfel::SurfelCloud cloud;
  size_t own = 0;
};

/// Second phase: gives the surfels of a part their final normals and radii. `inputs`: see MadePart.
void settle_surfels(const SceneDecisions& decisions, const estimation::SurfaceSpacing& spacing, size_t part,
                    std::span<const size_t> inputs, estimation::PartSurfels& surfels);

}  // namespace surfcast::builder
