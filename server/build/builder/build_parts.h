#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "builder/build_inputs.h"
#include "builder/divide_points.h"
#include "builder/make_part.h"
#include "builder/memory_budget.h"
#include "builder/part_store.h"
#include "builder/stage_clock.h"
#include "estimation/make_surfels.h"

namespace surfcast::builder {

/// The points of a build, divided into parts that fit into memory. A single part stays in memory; several are kept on
/// disk.
class BuildParts {
 public:
  /// Counts the points in octree cells, plans the parts, and distributes the points to them.
  static Result<BuildParts> gather(const BuildInputs& inputs, const Division& division,
                                   const std::filesystem::path& target, StageClock& clock,
                                   estimation::SurfelReport& report);

  /// Parts whose points were distributed already.
  BuildParts(std::unique_ptr<const BuildFrame> frame, PartStore store);

  [[nodiscard]] size_t size() const { return frame_->parts.size(); }
  [[nodiscard]] const Part& plan(size_t part) const { return frame_->parts[part]; }
  [[nodiscard]] const geometry::RootCube& root() const { return frame_->root; }
  [[nodiscard]] size_t parts_at_once(const MemoryPlan& memory) const;

  /// First phase: makes the surfels of every part, gathers the spacing of the surfaces, and decides for all parts the
  /// signs of normals and what stated radii mean.
  Status make_surfels(const MemoryPlan& memory, estimation::RadiusPolicy radii, StageClock& clock,
                      estimation::SurfelReport& report);
  /// Second phase: returns the surfels of a part with their final normals and radii. Each part can be taken once.
  /// Thread-safe.
  Result<FinishedPart> take(size_t part);

  [[nodiscard]] const estimation::ResolvedSigns& signs() const { return decisions_.signs; }
  [[nodiscard]] std::span<const estimation::RadiusDecision> radii() const {
    return decisions_.radii;
  }  ///< for each input

 private:
  BuildParts(const BuildInputs& inputs, std::vector<Part> plan);
  Status spool(const BuildInputs& inputs, const Division& division, const std::filesystem::path& target,
               StageClock& clock, estimation::SurfelReport& report);
  Status collect(const BuildInputs& inputs, StageClock& clock, estimation::SurfelReport& report);

  std::unique_ptr<const BuildFrame> frame_;
  std::optional<PartStore> store_;   ///< if there are several parts
  std::optional<PartPoints> whole_;  ///< a single part, before its surfels are made
  estimation::PartSurfels surfels_;  ///< a single part, after its surfels are made
  size_t own_ = 0;
  SceneDecisions decisions_;
  std::optional<estimation::SurfaceSpacing> spacing_;  ///< from the first phase on
};

}  // namespace surfcast::builder
