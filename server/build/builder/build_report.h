#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "builder/field_input.h"
#include "builder/mesh_input.h"
#include "builder/place_inputs.h"
#include "estimation/stated_radii.h"
#include "estimation/surfel_report.h"
#include "model/ellipsoid_source.h"
#include "simplify/simplify.h"

namespace surfcast::builder {

/// What became of the radii that an input states.
struct InputRadii {
  std::string input;  ///< file name without its folders
  estimation::RadiusDecision decision;
};

/// What became of the samples of a tensor field or of a table of ellipsoids.
struct InputEllipsoids {
  std::string input;  ///< name of the field
  model::EllipsoidCounts counts;
};

/// What became of a model to which scans were added.
struct AppendedBlocks {
  uint64_t surfels_before = 0;
  uint64_t blocks_copied = 0;  ///< byte for byte
};

/// The result and the cost of a build.
struct BuildReport {
  estimation::SurfelReport scan;
  std::vector<InputRadii> radii;  ///< of the inputs that have a column for them
  std::vector<InputMesh> meshes;
  std::vector<TransformedInput> transformed{};  ///< the inputs that were brought into the system of the model
  model::Georeference georeference{};           ///< of the model
  std::optional<simplify::SimplifyReport> simplified{};
  std::optional<AppendedBlocks> appended{};  ///< of append_to_model
  uint64_t points_in_scans = 0;              ///< beyond BuildOptions::sample too
  uint64_t samples = 0;                      ///< of the volumes
  std::vector<InputField> fields{};          ///< scans that became volumes
  uint64_t surfels = 0;
  uint64_t gaussians = 0;
  std::vector<InputEllipsoids> ellipsoids;  ///< of the inputs that have some
  uint64_t blocks = 0;
  uint64_t bytes = 0;                                  ///< of the model file
  uint64_t parts = 0;                                  ///< parts in which the scan was processed
  uint64_t memory_budget = 0;                          ///< bytes
  double seconds = 0;                                  ///< wall time of the whole build
  uint64_t peak_memory = 0;                            ///< peak resident size of this process so far, bytes
  std::vector<std::pair<std::string, double>> stages;  ///< seconds of each stage

  /// Ellipsoids of all inputs that are drawn.
  [[nodiscard]] uint64_t drawn_ellipsoids() const {
    uint64_t drawn = 0;
    for (const InputEllipsoids& input : ellipsoids) drawn += input.counts.drawn;
    return drawn;
  }
  [[nodiscard]] double points_per_second() const { return static_cast<double>(scan.points_read) / seconds; }
  [[nodiscard]] double samples_per_second() const { return static_cast<double>(samples) / seconds; }
};

/// Progress of a build.
struct BuildStep {
  const char* stage = "";
  double done = 0;      ///< completed share of the stage, in [0, 1]
  uint64_t points = 0;  ///< total number of points of the stage; 0 while unknown
};

/// Called from any thread, but from one at a time.
using BuildProgress = std::function<void(const BuildStep&)>;

}  // namespace surfcast::builder
