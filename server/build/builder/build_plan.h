#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "builder/build_inputs.h"
#include "builder/part_plan.h"
#include "builder/place_inputs.h"
#include "estimation/stated_radii.h"
#include "estimation/surfel_report.h"
#include "scan/selection.h"

namespace surfcast::builder {

/// What a build in parts was asked for.
struct PlanRequest {
  std::string program;              ///< version of the program, which all steps must have
  std::optional<double> precision;  ///< this and the following: see BuildOptions
  std::optional<bool> z_up;
  estimation::RadiusPolicy radii = estimation::RadiusPolicy::kAuto;
  scan::Selection selection;
  SystemOptions systems;
  std::optional<size_t> parts;  ///< none: as many as the memory needs
  uint64_t memory = 0;          ///< bytes that a step may take
};

/// By what a changed input is noticed.
struct InputIdentity {
  uint64_t files = 0;
  uint64_t bytes = 0;    ///< of all files
  int64_t modified = 0;  ///< the last change of any of them, nanoseconds of the clock of the file system
  bool operator==(const InputIdentity&) const = default;
};

struct PlannedInput {
  std::filesystem::path path;  ///< absolute
  InputIdentity identity;
  InputFacts facts;
};

/// Pieces of the inputs, numbered over all inputs: [first, first + count).
struct PieceRun {
  uint64_t first = 0;
  uint64_t count = 0;
  bool operator==(const PieceRun&) const = default;
};

struct PlannedPart {
  Part part;
  std::vector<PieceRun> pieces;  ///< those that may hold points of the part or of its halo, ascending
};

/// All that the steps of a build in parts have in common.
struct BuildPlan {
  PlanRequest request;
  std::vector<PlannedInput> inputs;
  std::vector<PlannedPart> parts;
  estimation::SurfelReport report;  ///< what was read and dropped
  std::string digest;               ///< of all of the above, 32 hexadecimal digits

  /// For each input, whether the part needs it.
  [[nodiscard]] std::vector<bool> inputs_of(size_t part) const;
  [[nodiscard]] std::vector<size_t> pieces_of(size_t part) const;
  [[nodiscard]] std::vector<Part> divided() const;
};

/// Identity of an input at this moment. Fails if a file of it is missing.
Result<InputIdentity> identity_of(const std::filesystem::path& path);

/// Numbers in ascending order as runs.
std::vector<PieceRun> runs_of(const std::vector<size_t>& pieces);

/// Two requests for the same plan of the same inputs give the same text.
std::string text_of(const PlanRequest& request);

/// The plan as JSON that a person can read, with its version and digest. Sets the digest. Fails if a name is not UTF-8.
Result<std::string> write_plan(BuildPlan& plan);
/// Fails with kInvalidInput if the text is damaged, with kUnsupported if it is of another version of the format.
Result<BuildPlan> read_plan(const std::string& text);

}  // namespace surfcast::builder
