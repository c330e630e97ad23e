#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "builder/build_inputs.h"
#include "builder/field_input.h"
#include "builder/input_files.h"
#include "builder/mesh_input.h"
#include "builder/place_inputs.h"
#include "estimation/stated_radii.h"
#include "estimation/surfel_report.h"
#include "grid/grid_header.h"
#include "model/ellipsoid_source.h"
#include "scan/selection.h"
#include "scattered/field_options.h"
#include "simplify/simplify.h"

namespace surfcast::builder {

struct BuildOptions {
  std::optional<double> precision;      ///< largest position error, world units; none: 1/256 of each radius
  std::optional<bool> z_up;             ///< vertical axis z (true) or y; none: as each scan's format or points suggest
  std::optional<uint64_t> memory;       ///< limit of resident memory, bytes; none: a quarter of the machine's memory
  std::optional<uint64_t> part_points;  ///< largest number of points of a part; none: as the memory allows
  std::optional<size_t> parts{};        ///< parts that scans are divided into; none: as the memory allows
  estimation::RadiusPolicy radii = estimation::RadiusPolicy::kAuto;
  std::optional<uint64_t> sample{};  ///< points of each scan, spread over it, that a preview is made of; none: all
  std::optional<simplify::ErrorBound> simplify{};  ///< of the surfaces of scans; none: every point is kept
  scan::Selection selection{};                     ///< points of scans that are read, where `open` does not read them
  MeshOptions meshes{};
  SystemOptions systems{};          ///< where scans and meshes lie on the earth
  OpenInput open{};                 ///< how scans and grids are read as points; none: grids become volumes
  std::optional<InputKind> kind{};  ///< of all inputs, whatever their content; none: as it says
  std::optional<scattered::FieldOptions> field{};   ///< scans with its column of values become volumes
  std::optional<grid::TensorOrder> tensor_order{};  ///< of six components that nothing says the order of
};

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

/// Reads scans and makes surfels, reads regular grids (build_volumes), models of Gaussians (build_gaussians) and
/// ellipsoids (build_ellipsoids), and writes one model file, which appears only when it is complete. Inputs keep their
/// kinds. Blocks come in the order surfels, bricks, Gaussians, ellipsoids, whatever the order of the inputs; colours
/// and the vertical axis of the model are those of the first of these kinds. Scans that exceed the memory budget are
/// processed in parts, kept in a temporary file beside the target. The model depends on the input and the options: not
/// on the number of threads, and only minimally on the division into parts.
Result<BuildReport> build_model(std::span<const std::filesystem::path> inputs, const std::filesystem::path& target,
                                const BuildOptions& options, const BuildProgress& progress);

}  // namespace surfcast::builder
