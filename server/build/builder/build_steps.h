#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "builder/build_plan.h"
#include "builder/build_report.h"

namespace surfcast::builder {

// A build whose parts are worked on by any number of processes, on any machines that share a folder:
//
//   plan_build         reads all inputs, divides their points into parts, and writes WORK/plan and WORK/parts
//   build_part         for each part, in any order: its points and those around it become surfels, WORK/part-K
//   build_signs        once all parts are there: what depends on the whole scene, WORK/signs
//   build_part_blocks  for each part, in any order: its blocks, WORK/blocks-K
//   merge_parts        once all blocks are there: the model
//
// Parts are numbered from 1 on, as in the names of the files. A file appears only when it is complete, and is checked
// when it is read. A step whose result is there does nothing; one that was stopped is run again. WORK/part-K may be
// deleted once WORK/blocks-K is there. The model has the bytes that build_model gives with the same division. All
// errors name a file; an error about what an earlier step has not made names that step.

/// Where a step works.
struct WorkPlace {
  std::filesystem::path folder;
  std::string program;  ///< version of this program, which must be that of the plan
};

struct PlanOutcome {
  bool done_before = false;
  uint64_t inputs = 0;
  uint64_t points = 0;  ///< including unusable ones
  uint64_t parts = 0;
  uint64_t largest_part = 0;       ///< points, without the halo
  std::vector<std::string> notes;  ///< one line each, for people
  std::vector<TransformedInput> transformed;
  model::Georeference georeference;
};

/// Only scans are built in parts. A plan for other inputs or another request replaces that of the folder, which is made
/// if it does not exist.
Result<PlanOutcome> plan_build(std::span<const std::filesystem::path> inputs, const std::filesystem::path& folder,
                               const PlanRequest& request, const BuildProgress& progress);

struct PartOutcome {
  bool done_before = false;
  uint64_t own = 0;   ///< surfels of the part
  uint64_t halo = 0;  ///< surfels around it
};

Result<PartOutcome> build_part(const WorkPlace& work, size_t part, const BuildProgress& progress);

struct SignsOutcome {
  bool done_before = false;
  bool oriented = false;
  std::vector<InputRadii> radii;
  std::vector<std::string> notes;
};

Result<SignsOutcome> build_signs(const WorkPlace& work, const BuildProgress& progress);

struct BlocksOutcome {
  bool done_before = false;
  uint64_t blocks = 0;
  uint64_t surfels = 0;
};

Result<BlocksOutcome> build_part_blocks(const WorkPlace& work, size_t part, const BuildProgress& progress);

struct MergeOutcome {
  bool done_before = false;
  uint64_t points_read = 0;
  uint64_t surfels = 0;
  uint64_t blocks = 0;
  uint64_t bytes = 0;
};

/// Takes memory for the table of blocks and for the coarsest surfels of each part, about 1 MiB a part.
Result<MergeOutcome> merge_parts(const WorkPlace& work, const std::filesystem::path& target,
                                 const BuildProgress& progress);

}  // namespace surfcast::builder
