#include "builder/build_model.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "builder/build_checks.h"
#include "builder/build_inputs.h"
#include "builder/build_kinds.h"
#include "builder/build_parts.h"
#include "builder/grid_input.h"
#include "builder/memory_budget.h"
#include "builder/model_output.h"
#include "builder/model_properties.h"
#include "builder/ordered_work.h"
#include "builder/part_blocks.h"
#include "builder/stage_clock.h"
#include "ellipsoid/ellipsoid_input.h"
#include "grid/open_scan.h"
#include "ldc/subtree.h"
#include "model/model_writer.h"
#include "model/write_blocks.h"
#include "surfel/curvature.h"

namespace surfcast::builder {
namespace {

/// Computes the weights of all surfels, makes the blocks and writes them, part by part.
class ModelPass {
 public:
  /// `simplified`: the surfels of the only part, if they were simplified.
  ModelPass(BuildParts& parts, model::ModelWriter& writer, const BuildOptions& options,
            std::optional<FinishedPart> simplified)
      : parts_(parts), writer_(writer), simplified_(std::move(simplified)), precision_(options.precision) {}

  Status write_parts(const MemoryPlan& memory, StageClock& clock) {
    clock.begin("writing blocks", parts_.size());
    return work_in_order(parts_.size(), parts_.parts_at_once(memory),
                         [&](size_t part) -> Result<std::function<Status()>> {
                           Result<PartBlocks> blocks = make_blocks(part);
                           if (!blocks) return fail(blocks);
                           return [this, &clock, shared = std::make_shared<PartBlocks>(std::move(*blocks))] {
                             clock.step();
                             return write(*shared);
                           };
                         });
  }

  Status write_levels_above(const surfel::SurfelCloud& common) {
    const auto first = static_cast<uint32_t>(blocks_);
    const std::vector<ldc::TreeBlock> blocks =
        ldc::build_levels_above(std::move(front_), parts_.root(), ldc::coarse_attributes(common), first);
    return model::write_blocks(writer_, common, blocks, {});
  }

 private:
  Result<PartBlocks> make_blocks(size_t part) {
    Result<FinishedPart> surfels = simplified_ ? std::move(*simplified_) : parts_.take(part);
    if (!surfels) return fail(surfels);
    return make_part_blocks(std::move(*surfels), parts_.plan(part), parts_.root(), precision_);
  }

  Status write(PartBlocks& part) {
    renumber(static_cast<uint32_t>(blocks_), part.subtree);
    blocks_ += part.subtree.blocks.size();
    for (ldc::FrontCell& cell : part.subtree.front) front_.push_back(std::move(cell));
    return model::write_blocks(writer_, part.cloud, part.subtree.blocks, {});
  }

  BuildParts& parts_;
  model::ModelWriter& writer_;
  std::optional<FinishedPart> simplified_;
  std::optional<double> precision_;
  size_t blocks_ = 0;
  ldc::Front front_;
};

/// A patch may be as wide as the model: all samples have to be at hand.
Status check_whole(const BuildParts& parts, const std::filesystem::path& target) {
  if (parts.size() == 1) return {};
  return fail(ErrorKind::kLimit, target.string() +
                                     ": --simplify needs all points at once, and they do not fit into the "
                                     "memory of the build; allow more with --memory");
}

std::string describe(const simplify::SimplifyReport& report) {
  return "not simplified, because " + report.reason;
}

/// The surfels of the only part, simplified.
Result<FinishedPart> simplify_whole(BuildParts& parts, const simplify::ErrorBound& bound, StageClock& clock,
                                    BuildReport& report) {
  clock.begin("simplifying", 1);
  Result<FinishedPart> surfels = parts.take(0);
  if (!surfels) return surfels;
  report.simplified = simplify::simplify(bound, surfels->cloud);
  surfels->own = surfels->cloud.size();
  if (!report.simplified->pays) report.scan.notes.push_back(describe(*report.simplified));
  clock.step();
  return surfels;
}

/// The properties of a model of these surfels.
void take_properties(const surfel::SurfelCloud& cloud, surfel::SurfelCloud& common) {
  common.estimated_normals = cloud.estimated_normals;
  common.estimated_radii = cloud.estimated_radii;
  if (!surfel::CurvatureColumns(cloud.scalars).empty()) surfel::add_curvature({}, common);
}

Status write(const BuildInputs& inputs, BuildParts& parts, const MemoryPlan& memory, ModelOutput& output,
             const BuildOptions& options, StageClock& clock, BuildReport& report) {
  surfel::SurfelCloud common = common_cloud(inputs, parts.signs().oriented);
  std::optional<FinishedPart> simplified;
  if (options.simplify) {
    if (Status status = check_whole(parts, output.target()); !status) return status;
    Result<FinishedPart> surfels = simplify_whole(parts, *options.simplify, clock, report);
    if (!surfels) return fail(surfels);
    simplified = std::move(*surfels);
    take_properties(simplified->cloud, common);
  }
  model::ModelSchema schema = model::schema_of(common);
  schema.even = !options.simplify && is_even(inputs, options.radii);
  const Result<model::ModelWriter*> writer = output.writer(std::move(schema));
  if (!writer) return fail(writer);
  (*writer)->set_georeference(report.georeference);
  ModelPass pass(parts, **writer, options, std::move(simplified));
  if (Status status = pass.write_parts(memory, clock); !status) return status;
  clock.begin("writing levels above", 1);
  return pass.write_levels_above(common);
}

/// Meshes become surfels, and scans are read, unless the options say otherwise.
OpenInput opener(const BuildOptions& options, const std::filesystem::path& target, BuildReport& report) {
  const OpenInput read = [&options](const std::filesystem::path& input, const scan::DecodingLimit& limit,
                                    std::optional<uint64_t> sample) {
    return grid::open_scan(input, limit, sample, options.selection);
  };
  const OpenInput other = options.open ? options.open : read;
  return [&options, &report, target, other](const std::filesystem::path& input, const scan::DecodingLimit& limit,
                                            std::optional<uint64_t> sample) {
    if (!is_mesh(input, options.meshes.faces)) return other(input, limit, sample);
    return open_mesh(input, options.meshes, limit, sample, target, report.meshes);
  };
}

/// Makes surfels of scans and adds their blocks to a model.
Status build_surfels(std::span<const std::filesystem::path> inputs, ModelOutput& output, const BuildOptions& options,
                     StageClock& clock, BuildReport& report) {
  const std::filesystem::path& target = output.target();
  clock.begin("reading", inputs.size());
  const OpenInput open = opener(options, target, report);
  Result<BuildInputs> opened = BuildInputs::open(inputs, open, options.z_up, report.memory_budget, options.sample,
                                                 [&clock](double) { clock.step(); });
  if (!opened) return fail(opened);
  Result<Placement> placement = opened->place(options.systems);
  if (!placement) return fail_about(target.string(), placement);
  report.points_in_scans = opened->size_of_files();
  clock.know_points(opened->size());
  if (Status status = check_bounds(opened->bounds(), target); !status) return status;
  Result<MemoryPlan> memory = plan_memory(report.memory_budget, opened->held_bytes(), opened->schema());
  if (!memory) return fail_about(target.string(), memory);
  if (options.part_points) memory->split_into(*options.part_points);
  report.scan.notes = opened->notes();
  report.scan.notes.insert(report.scan.notes.end(), placement->notes.begin(), placement->notes.end());
  report.transformed = std::move(placement->transformed);
  report.georeference = std::move(placement->georeference);
  for (const InputMesh& mesh : report.meshes) {
    for (const std::string& note : mesh.report.notes) report.scan.notes.push_back(mesh.input + ": " + note);
  }
  Result<BuildParts> parts = BuildParts::gather(*opened, {*memory, options.parts}, target, clock, report.scan);
  if (!parts) return fail(parts);
  report.parts += parts->size();
  Status made = parts->make_surfels(*memory, options.radii, clock, report.scan);
  if (!made) return made;
  report.radii = radii_of(opened->schemas(), parts->radii());
  const std::vector<std::string> unused = unused_radii(options.radii, report.radii);
  report.scan.notes.insert(report.scan.notes.end(), unused.begin(), unused.end());
  return write(*opened, *parts, *memory, output, options, clock, report);
}

/// The inputs of each kind, in their order.
struct InputsByKind {
  std::vector<std::filesystem::path> scans;
  std::vector<std::filesystem::path> grids;
  std::vector<std::filesystem::path> fields;
  std::vector<std::filesystem::path> gaussians;
  std::vector<std::filesystem::path> ellipsoids;

  std::vector<std::filesystem::path>& of(InputKind kind) {
    switch (kind) {
      case InputKind::kGrid:
        return grids;
      case InputKind::kGaussians:
        return gaussians;
      case InputKind::kEllipsoids:
        return ellipsoids;
      case InputKind::kMesh:  // is read as a scan of its surfels
      case InputKind::kScan:
        break;
    }
    return scans;
  }
};

InputKind kind_of(const std::filesystem::path& input, const BuildOptions& options) {
  if (options.kind) return *options.kind;
  // A file whose order of components is stated holds tensors.
  if (ellipsoid::holds_ellipsoids(input, {options.tensor_order, {}, false, {}})) return InputKind::kEllipsoids;
  const InputKind kind = kind_of_input(input);
  return options.open && kind == InputKind::kGrid ? InputKind::kScan : kind;
}

InputsByKind by_kind(std::span<const std::filesystem::path> inputs, const BuildOptions& options, uint64_t memory) {
  InputsByKind kinds;
  for (const std::filesystem::path& input : inputs) {
    const InputKind kind = kind_of(input, options);
    const bool field = options.field && kind == InputKind::kScan && holds_field(input, *options.field, memory);
    (field ? kinds.fields : kinds.of(kind)).push_back(input);
  }
  return kinds;
}

/// Finds errors of the headers of what is read last before anything is worked on.
Status check_headers(const InputsByKind& inputs) {
  for (const std::filesystem::path& grid : inputs.grids) {
    if (const Result<GridInput> opened = GridInput::open(grid); !opened) return fail(opened);
  }
  return {};
}

/// Adds the inputs kind by kind: what one kind holds in memory is free before the next.
Status build_kinds(const InputsByKind& inputs, ModelOutput& output, const BuildOptions& options, StageClock& clock,
                   BuildReport& report) {
  Status status = check_headers(inputs);
  if (status && options.field && inputs.fields.empty()) {
    return fail(ErrorKind::kInvalidInput,
                output.target().string() + ": no input is a table of points with a column " + options.field->value);
  }
  if (status && inputs.scans.empty() && (!options.systems.assigned.empty() || !options.systems.target.empty())) {
    return fail(ErrorKind::kInvalidInput, output.target().string() +
                                              ": no input has coordinates on the earth: "
                                              "--crs and --to-crs need a scan or a mesh");
  }
  if (status && !inputs.scans.empty()) status = build_surfels(inputs.scans, output, options, clock, report);
  if (status && (!inputs.grids.empty() || !inputs.fields.empty())) {
    status = build_volumes(inputs.grids, inputs.fields, output, options, clock, report);
  }
  if (status && !inputs.gaussians.empty()) status = build_gaussians(inputs.gaussians, output, options, clock, report);
  if (status && !inputs.ellipsoids.empty()) {
    status = build_ellipsoids(inputs.ellipsoids, output, options, clock, report);
  }
  if (!status) return status;
  const Result<model::WriteReport> written = output.finish();
  if (!written) return fail(written);
  report.surfels = written->surfels;
  report.blocks = written->blocks;
  report.bytes = written->bytes;
  return {};
}

}  // namespace

Result<BuildReport> build_model(std::span<const std::filesystem::path> inputs, const std::filesystem::path& target,
                                const BuildOptions& options, const BuildProgress& progress) {
  const Stopwatch stopwatch;
  BuildReport report;
  if (Status status = check_target(target, inputs); !status) return fail(status);
  const Result<uint64_t> budget = memory_budget(options.memory);
  if (!budget) return fail_about(target.string(), budget);
  report.memory_budget = *budget;
  ModelOutput output(target);
  {
    StageClock clock(progress, report);
    Status status = build_kinds(by_kind(inputs, options, *budget), output, options, clock, report);
    if (!status) return fail(status);
  }
  report.seconds = stopwatch.seconds();
  report.peak_memory = peak_resident_bytes();
  return report;
}

}  // namespace surfcast::builder
