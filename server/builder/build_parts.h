#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "builder/build_inputs.h"
#include "builder/memory_budget.h"
#include "builder/part_finder.h"
#include "builder/part_plan.h"
#include "builder/part_store.h"
#include "builder/stage_clock.h"
#include "geometry/morton.h"
#include "scan/make_surfels.h"

namespace surfcast::builder {

/// The points of a build, divided into parts that fit into memory. A single part stays in memory; several are kept on
/// disk.
class BuildParts {
 public:
  /// Counts the points in octree cells, plans the parts, and distributes the points to them.
  static Result<BuildParts> gather(const BuildInputs& inputs, const MemoryPlan& memory,
                                   const std::filesystem::path& target, StageClock& clock, scan::SurfelReport& report);

  [[nodiscard]] size_t size() const { return plan_.size(); }
  [[nodiscard]] const Part& plan(size_t part) const { return plan_[part]; }
  [[nodiscard]] const geometry::RootCube& root() const { return root_; }
  [[nodiscard]] size_t parts_at_once(const MemoryPlan& memory) const;

  /// First phase: makes the surfels of every part, gathers the spacing of the surfaces, and decides for all parts the
  /// signs of normals and what stated radii mean.
  Status make_surfels(const MemoryPlan& memory, scan::RadiusPolicy radii, StageClock& clock,
                      scan::SurfelReport& report);
  /// Second phase: returns the surfels of a part with their final normals and radii, own surfels before those of the
  /// halo. Each part can be taken once. Thread-safe.
  struct Finished {
    surfel::SurfelCloud cloud;
    size_t own = 0;
  };
  Result<Finished> take(size_t part);

  [[nodiscard]] const scan::ResolvedSigns& signs() const { return signs_; }
  [[nodiscard]] std::span<const scan::RadiusDecision> radii() const { return radii_; }  ///< for each input

 private:
  struct Made {
    scan::PartSurfels surfels;
    size_t own = 0;
    std::vector<uint32_t> order;  ///< of the points, if there are several parts
    std::vector<uint8_t> kept;
    scan::PartSigns signs;
    scan::SurfelReport report;
  };

  BuildParts(const BuildInputs& inputs, std::vector<Part> plan, const geometry::RootCube& root);
  Status spool(const BuildInputs& inputs, const MemoryPlan& memory, const std::filesystem::path& target,
               StageClock& clock, scan::SurfelReport& report);
  Status collect(const BuildInputs& inputs, StageClock& clock, scan::SurfelReport& report);
  [[nodiscard]] Made make(PartPoints points, size_t part, scan::RadiusPolicy radii) const;
  [[nodiscard]] scan::RadiusPolicy policy_of(size_t input, scan::RadiusPolicy policy) const;
  void decide_radii(const std::vector<scan::RadiusComparison>& comparisons, scan::RadiusPolicy policy,
                    scan::SurfelReport& report);

  scan::Scene scene_;
  geometry::Box bounds_;
  uint64_t points_ = 0;  ///< of all inputs
  geometry::RootCube root_;
  std::vector<std::optional<glm::dvec3>> sensors_;    ///< for each input
  std::vector<std::optional<double>> surface_steps_;  ///< for each input, see ScanSchema
  std::vector<bool> exact_radii_;                     ///< for each input, see ScanSchema
  bool two_sided_ = false;                            ///< of some input
  std::vector<InputName> names_;
  std::vector<Part> plan_;
  PartFinder finder_;
  std::optional<PartStore> store_;   ///< if there are several parts
  std::optional<PartPoints> whole_;  ///< a single part, before its surfels are made
  scan::PartSurfels surfels_;        ///< a single part, after its surfels are made
  size_t own_ = 0;
  scan::ResolvedSigns signs_;
  std::vector<scan::RadiusDecision> radii_;      ///< for each input
  std::optional<scan::SurfaceSpacing> spacing_;  ///< from the first phase on
};

}  // namespace surfcast::builder
