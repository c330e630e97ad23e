#include "builder/build_steps.h"

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>

#include <oneapi/tbb/info.h>

#include "base/atomic_file.h"
#include "builder/build_checks.h"
#include "builder/divide_points.h"
#include "builder/input_files.h"
#include "builder/make_part.h"
#include "builder/memory_budget.h"
#include "builder/merge_blocks.h"
#include "builder/model_properties.h"
#include "builder/ordered_work.h"
#include "builder/part_blocks.h"
#include "builder/stage_clock.h"
#include "builder/step_content.h"
#include "builder/work_folder.h"
#include "grid/open_scan.h"
#include "model/model_writer.h"

namespace surfcast::builder {
namespace {

namespace fs = std::filesystem;

/// The stages of one step.
class StepClock {
 public:
  explicit StepClock(const BuildProgress& progress) : clock_(progress, report_) {}
  StageClock& operator*() { return clock_; }

 private:
  BuildReport report_;
  StageClock clock_;
};

Status check_kind(const fs::path& input) {
  if (kind_of_input(input) == InputKind::kScan) return {};
  return fail(ErrorKind::kUnsupported, input.string() + ": only scans are built in parts, and this is none");
}

/// The inputs as the plan names them, and their identities.
Result<std::vector<PlannedInput>> name_inputs(std::span<const fs::path> inputs) {
  std::vector<PlannedInput> named;
  for (const fs::path& input : inputs) {
    if (Status status = check_kind(input); !status) return fail(status);
    const Result<InputIdentity> identity = identity_of(input);
    if (!identity) return fail(identity);
    named.push_back({fs::absolute(input).lexically_normal(), *identity, {}});
  }
  return named;
}

bool are_same(const std::vector<PlannedInput>& a, const std::vector<PlannedInput>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const PlannedInput& p, const PlannedInput& q) {
    return p.path == q.path && p.identity == q.identity;
  });
}

/// What is found when the pieces of the inputs are read.
struct PieceSurvey {
  explicit PieceSurvey(size_t pieces) : boxes(pieces), reports(pieces) {}

  void see(size_t piece, const InputPiece& read, const estimation::SurfelReport& report) {
    geometry::Box box;
    for (const glm::dvec3& p : read.points.positions) box.include(p);
    boxes[piece] = box;
    reports[piece] = report;
  }

  std::vector<geometry::Box> boxes;  ///< of the usable points of each piece
  std::vector<estimation::SurfelReport> reports;
};

/// Reads all pieces, where the division has not done so.
Status read_pieces(const BuildInputs& inputs, PieceSurvey& survey, StageClock& clock) {
  clock.begin("counting", inputs.pieces());
  const auto threads = static_cast<size_t>(oneapi::tbb::info::default_concurrency());
  return work_in_order(inputs.pieces(), threads, [&](size_t i) -> Result<std::function<Status()>> {
    estimation::SurfelReport report;
    const Result<InputPiece> piece = inputs.read(i, report);
    if (!piece) return fail(piece);
    survey.see(i, *piece, report);
    clock.step();
    return [] { return Status(); };
  });
}

/// Divides the points, and finds the pieces that each part needs.
Status divide_into_parts(const BuildInputs& inputs, const Division& division, StageClock& clock, BuildPlan& plan) {
  const geometry::RootCube root = geometry::root_cube(inputs.bounds());
  PieceSurvey survey(inputs.pieces());
  const SeePiece see = [&survey](size_t piece, const InputPiece& read, const estimation::SurfelReport& report) {
    survey.see(piece, read, report);
  };
  const Result<std::vector<Part>> parts = divide_points(inputs, root, division, clock, see);
  if (!parts) return fail(parts);
  if (parts->size() == 1) {
    if (Status status = read_pieces(inputs, survey, clock); !status) return status;
  }
  for (const estimation::SurfelReport& report : survey.reports) plan.report.add(report);
  const PartFinder finder(*parts, root);
  for (uint32_t part = 0; part < parts->size(); ++part) {
    std::vector<size_t> pieces;
    for (size_t piece = 0; piece < survey.boxes.size(); ++piece) {
      if (finder.may_need(part, survey.boxes[piece])) pieces.push_back(piece);
    }
    plan.parts.push_back({(*parts)[part], runs_of(pieces)});
  }
  return {};
}

Result<MemoryPlan> memory_of(const BuildInputs& inputs, uint64_t budget, const fs::path& folder) {
  Result<MemoryPlan> memory = plan_memory(budget, inputs.held_bytes(), inputs.schema());
  if (!memory) return fail_about(folder.string(), memory);
  return memory;
}

std::vector<fs::path> paths_of(const std::vector<PlannedInput>& inputs) {
  std::vector<fs::path> paths;
  paths.reserve(inputs.size());
  for (const PlannedInput& input : inputs) paths.push_back(input.path);
  return paths;
}

Status write_plan_files(const fs::path& folder, BuildPlan& plan) {
  const Result<std::string> text = write_plan(plan);
  if (!text) return fail_about(folder.string(), text);
  // Who finds the plan finds the number of its parts, too.
  Status status = write_file_atomically(part_count_file(folder), std::to_string(plan.parts.size()) + "\n");
  return status ? write_file_atomically(plan_file(folder), *text) : status;
}

PlanOutcome outcome_of(const BuildPlan& plan) {
  PlanOutcome outcome;
  outcome.inputs = plan.inputs.size();
  outcome.parts = plan.parts.size();
  for (const PlannedInput& input : plan.inputs) outcome.points += input.facts.scan.points;
  for (const PlannedPart& part : plan.parts) outcome.largest_part = std::max(outcome.largest_part, part.part.count);
  return outcome;
}

/// The plan of the folder, if it is for these inputs and this request.
std::optional<PlanOutcome> planned_before(const fs::path& folder, const std::vector<PlannedInput>& inputs,
                                          const PlanRequest& request) {
  const Result<WorkFolder> found = WorkFolder::open(folder, request.program);
  if (!found || !are_same(found->plan().inputs, inputs) || text_of(found->plan().request) != text_of(request)) {
    return std::nullopt;
  }
  PlanOutcome outcome = outcome_of(found->plan());
  outcome.done_before = fs::exists(part_count_file(folder));
  return outcome.done_before ? std::optional(std::move(outcome)) : std::nullopt;
}

/// Reads the inputs and makes the plan.
Result<PlanOutcome> make_plan(BuildPlan plan, const fs::path& folder, StageClock& clock) {
  const PlanRequest& request = plan.request;
  const std::vector<fs::path> paths = paths_of(plan.inputs);
  clock.begin("reading", paths.size());
  const OpenInput open = [&request](const fs::path& input, const scan::DecodingLimit& limit,
                                    std::optional<uint64_t> sample) {
    return grid::open_scan(input, limit, sample, request.selection);
  };
  Result<BuildInputs> opened =
      BuildInputs::open(paths, open, request.z_up, request.memory, {}, [&clock](double) { clock.step(); });
  if (!opened) return fail(opened);
  Result<Placement> placement = opened->place(request.systems);
  if (!placement) return fail_about(folder.string(), placement);
  if (Status status = check_bounds(opened->bounds(), folder); !status) return fail(status);
  const Result<MemoryPlan> memory = memory_of(*opened, request.memory, folder);
  if (!memory) return fail(memory);
  clock.know_points(opened->size());
  for (size_t i = 0; i < paths.size(); ++i) plan.inputs[i].facts = opened->facts()[i];
  if (Status status = divide_into_parts(*opened, {*memory, request.parts}, clock, plan); !status) {
    return fail(status);
  }
  if (Status status = write_plan_files(folder, plan); !status) return fail(status);
  PlanOutcome outcome = outcome_of(plan);
  outcome.notes = opened->notes();
  outcome.notes.insert(outcome.notes.end(), placement->notes.begin(), placement->notes.end());
  outcome.transformed = std::move(placement->transformed);
  outcome.georeference = std::move(placement->georeference);
  return outcome;
}

/// The inputs of a plan, of which those are opened whose points are `read`.
Result<BuildInputs> reopen_inputs(const BuildPlan& plan, std::vector<bool> read) {
  std::vector<InputFacts> facts;
  for (const PlannedInput& input : plan.inputs) facts.push_back(input.facts);
  return BuildInputs::reopen({paths_of(plan.inputs), std::move(read), plan.request.selection, plan.request.z_up,
                              plan.request.memory, plan.request.systems},
                             std::move(facts));
}

/// The inputs, for what is known of them without their points.
Result<BuildInputs> describe_inputs(const BuildPlan& plan) {
  return reopen_inputs(plan, std::vector<bool>(plan.inputs.size()));
}

/// Fails if one of the inputs is not what was planned with.
Status check_unchanged(const BuildPlan& plan, const std::vector<bool>& needed, const fs::path& folder) {
  for (size_t i = 0; i < needed.size(); ++i) {
    if (!needed[i]) continue;
    const PlannedInput& input = plan.inputs[i];
    const Result<InputIdentity> identity = identity_of(input.path);
    if (!identity) return fail(identity);
    if (*identity == input.identity) continue;
    return fail(ErrorKind::kReplaced, input.path.string() + ": has changed since it was planned with; run `surfcastd " +
                                          "build-plan INPUT... --work " + folder.string() + "` again");
  }
  return {};
}

/// Writes the result of a step by `write`.
template <typename Write>
Status write_result(const WorkFolder& folder, WorkStep step, size_t part, const Write& write) {
  Result<WorkFileWriter> file = folder.create(step, part);
  if (!file) return fail(file);
  const Status status = write(*file);
  return status ? file->finish() : status;
}

/// The points of a part and those around it.
Result<PartPoints> gather_part(const BuildInputs& inputs, const BuildFrame& frame, const WorkFolder& folder,
                               size_t part, StageClock& clock) {
  const fs::path target = folder.file(WorkStep::kPart, part);
  Result<SpoolFile> spool = SpoolFile::create(target);
  if (!spool) return fail(spool);
  PartStore store(std::move(*spool), inputs.schema(), frame.names, frame.parts.size());
  estimation::SurfelReport counted_before;
  Status status = distribute_points(inputs, folder.plan().pieces_of(part), frame.finder, frame.root,
                                    static_cast<uint32_t>(part), store, clock, counted_before);
  if (!status) return fail(status);
  const Result<MemoryPlan> memory = memory_of(inputs, folder.plan().request.memory, target);
  if (!memory) return fail(memory);
  if (const uint64_t points = store.points(part); points > 0 && memory->parts_at_once(points) == 0) {
    return fail(ErrorKind::kLimit, target.string() + ": " + std::to_string(points) +
                                       " points are more than the memory of the plan holds; plan with more parts or "
                                       "more memory");
  }
  return store.load(part);
}

/// What all parts tell, read one after another. Adds up what they report.
Result<SceneEvidence> evidence_of(const WorkFolder& folder, size_t inputs, StageClock& clock,
                                  estimation::SurfelReport& report) {
  clock.begin("resolving signs", folder.parts());
  SceneEvidence evidence(inputs);
  for (size_t part = 0; part < folder.parts(); ++part) {
    const Result<WorkFile> file = folder.result(WorkStep::kPart, part);
    if (!file) return fail(file);
    Result<PartEvidence> own = read_evidence(*file);
    if (!own) return fail(own);
    evidence.add(std::move(own->signs), own->radii, own->samples);
    report.add(own->report);
    clock.step();
  }
  return evidence;
}

SignsOutcome outcome_of(const SceneResult& scene, const BuildInputs& inputs, estimation::RadiusPolicy policy) {
  SignsOutcome outcome;
  outcome.oriented = scene.report.oriented;
  outcome.radii = radii_of(inputs.schemas(), scene.decisions.radii);
  outcome.notes = unused_radii(policy, outcome.radii);
  return outcome;
}

/// What build_signs has decided.
Result<SceneResult> scene_of(const WorkFile& signs, const WorkFolder& folder, size_t inputs) {
  Result<SceneResult> scene = read_scene(signs);
  if (!scene) return scene;
  const bool fits = scene->decisions.signs.flipped.size() == folder.parts() && scene->decisions.radii.size() == inputs;
  if (!fits) return fail(signs.damaged());
  return scene;
}

/// A part with its final normals and radii.
Result<FinishedPart> finish_part(const WorkFolder& folder, size_t part, const BuildInputs& inputs,
                                 const BuildFrame& frame) {
  const Result<WorkFile> file = folder.result(WorkStep::kPart, part);
  if (!file) return fail(file);
  const Result<WorkFile> signs = folder.result(WorkStep::kSigns);
  if (!signs) return fail(signs);
  const Result<SceneResult> scene = scene_of(*signs, folder, frame.names.size());
  if (!scene) return fail(scene);
  Result<std::vector<estimation::SurfaceSample>> samples = read_samples(*signs);
  if (!samples) return fail(samples);
  Result<MadePart> made = read_surfels(*file, inputs.schema(), frame.names);
  if (!made) return fail(made);
  const estimation::SurfaceSpacing spacing(std::move(*samples), frame.bounds);
  settle_surfels(scene->decisions, spacing, part, made->inputs, made->surfels);
  return FinishedPart{std::move(made->surfels.cloud), made->own};
}

Result<model::WriteReport> write_model_of(const WorkFolder& folder, const BuildInputs& inputs, const SceneResult& scene,
                                          const fs::path& target, StageClock& clock) {
  const surfel::SurfelCloud common = common_cloud(inputs, scene.decisions.signs.oriented);
  model::ModelSchema schema = model::schema_of(common);
  schema.even = is_even(inputs, folder.plan().request.radii);
  Result<model::ModelWriter> writer = model::ModelWriter::create(target, std::move(schema));
  if (!writer) return fail(writer);
  writer->set_georeference(inputs.georeference());
  const geometry::RootCube root = geometry::root_cube(inputs.bounds());
  if (Status status = merge_blocks(folder, root, common, clock, *writer); !status) return fail(status);
  return writer->finish();
}

/// What tells a model that was merged from one that has been replaced since; empty without a file.
std::string trace_of(const fs::path& target) {
  const Result<InputIdentity> identity = identity_of(target);
  if (!identity) return {};
  return fs::absolute(target).lexically_normal().string() + '\n' + std::to_string(identity->bytes) + '\n' +
         std::to_string(identity->modified);
}

std::span<const std::byte> bytes_of_text(const std::string& text) {
  return std::as_bytes(std::span(text));
}

bool is_merged(const WorkFolder& folder, const fs::path& target) {
  if (!folder.is_done(WorkStep::kMerge)) return false;
  const Result<std::vector<std::byte>> noted =
      folder.result(WorkStep::kMerge).and_then([](const WorkFile& file) { return file.read(0); });
  const std::string trace = trace_of(target);
  return noted && !trace.empty() && std::ranges::equal(*noted, bytes_of_text(trace));
}

Status note_merged(const WorkFolder& folder, const fs::path& target) {
  return write_result(folder, WorkStep::kMerge, 0,
                      [&target](WorkFileWriter& file) { return file.add(bytes_of_text(trace_of(target))); });
}

/// A part is not needed any more once its blocks are there, and the signs that they were made with.
bool is_part_done(const WorkFolder& folder, size_t part) {
  return folder.is_done(WorkStep::kPart, part) ||
         (folder.is_done(WorkStep::kBlocks, part) && folder.is_done(WorkStep::kSigns));
}

}  // namespace

Result<PlanOutcome> plan_build(std::span<const fs::path> inputs, const fs::path& folder, const PlanRequest& request,
                               const BuildProgress& progress) {
  Result<std::vector<PlannedInput>> named = name_inputs(inputs);
  if (!named) return fail(named);
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) return fail(ErrorKind::kIo, folder.string() + ": cannot make this folder: " + code.message());
  if (std::optional<PlanOutcome> before = planned_before(folder, *named, request)) return std::move(*before);
  BuildPlan plan;
  plan.request = request;
  plan.inputs = std::move(*named);
  StepClock clock(progress);
  return make_plan(std::move(plan), folder, *clock);
}

Result<PartOutcome> build_part(const WorkPlace& work, size_t part, const BuildProgress& progress) {
  const Result<WorkFolder> folder = WorkFolder::open(work.folder, work.program);
  if (!folder) return fail(folder);
  const Result<size_t> index = folder->index_of(part);
  if (!index) return fail(index);
  if (is_part_done(*folder, *index)) return PartOutcome{true, 0, 0};
  const BuildPlan& plan = folder->plan();
  const std::vector<bool> needed = plan.inputs_of(*index);
  if (Status status = check_unchanged(plan, needed, work.folder); !status) return fail(status);
  const Result<BuildInputs> inputs = reopen_inputs(plan, needed);
  if (!inputs) return fail(inputs);
  StepClock clock(progress);
  (*clock).know_points(plan.parts[*index].part.count);
  const BuildFrame frame(*inputs, plan.divided());
  Result<PartPoints> points = gather_part(*inputs, frame, *folder, *index, *clock);
  if (!points) return fail(points);
  (*clock).begin("making surfels", 1);
  MadePart made = make_part(frame, std::move(*points), *index, plan.request.radii, false);
  const Status status =
      write_result(*folder, WorkStep::kPart, *index, [&made](WorkFileWriter& file) { return write_part(file, made); });
  if (!status) return fail(status);
  return PartOutcome{false, made.own, made.surfels.cloud.size() - made.own};
}

Result<SignsOutcome> build_signs(const WorkPlace& work, const BuildProgress& progress) {
  const Result<WorkFolder> folder = WorkFolder::open(work.folder, work.program);
  if (!folder) return fail(folder);
  if (folder->is_done(WorkStep::kSigns)) return SignsOutcome{true, false, {}, {}};
  if (Status status = folder->check_all(WorkStep::kPart); !status) return fail(status);
  const Result<BuildInputs> inputs = describe_inputs(folder->plan());
  if (!inputs) return fail(inputs);
  StepClock clock(progress);
  const BuildFrame frame(*inputs, folder->plan().divided());
  SceneResult scene;
  Result<SceneEvidence> evidence = evidence_of(*folder, frame.names.size(), *clock, scene.report);
  if (!evidence) return fail(evidence);
  scene.decisions = evidence->decide(frame, folder->plan().request.radii, scene.report);
  const std::vector<estimation::SurfaceSample> samples = std::move(*evidence).take_samples();
  const Status status = write_result(*folder, WorkStep::kSigns, 0,
                                     [&](WorkFileWriter& file) { return write_scene(file, scene, samples); });
  if (!status) return fail(status);
  return outcome_of(scene, *inputs, folder->plan().request.radii);
}

Result<BlocksOutcome> build_part_blocks(const WorkPlace& work, size_t part, const BuildProgress& progress) {
  const Result<WorkFolder> folder = WorkFolder::open(work.folder, work.program);
  if (!folder) return fail(folder);
  const Result<size_t> index = folder->index_of(part);
  if (!index) return fail(index);
  if (folder->is_done(WorkStep::kBlocks, *index)) return BlocksOutcome{true, 0, 0};
  const Result<BuildInputs> inputs = describe_inputs(folder->plan());
  if (!inputs) return fail(inputs);
  StepClock clock(progress);
  (*clock).begin("writing blocks", 1);
  const BuildFrame frame(*inputs, folder->plan().divided());
  Result<FinishedPart> finished = finish_part(*folder, *index, *inputs, frame);
  if (!finished) return fail(finished);
  const size_t own = finished->own;
  const PartBlocks made =
      make_part_blocks(std::move(*finished), frame.parts[*index], frame.root, folder->plan().request.precision);
  const Status status = write_result(*folder, WorkStep::kBlocks, *index,
                                     [&made](WorkFileWriter& file) { return write_part_blocks(file, made); });
  if (!status) return fail(status);
  return BlocksOutcome{false, made.subtree.blocks.size(), own};
}

Result<MergeOutcome> merge_parts(const WorkPlace& work, const fs::path& target, const BuildProgress& progress) {
  const Result<WorkFolder> folder = WorkFolder::open(work.folder, work.program);
  if (!folder) return fail(folder);
  const BuildPlan& plan = folder->plan();
  if (Status status = check_target(target, paths_of(plan.inputs)); !status) return fail(status);
  if (is_merged(*folder, target)) return MergeOutcome{true, 0, 0, 0, 0};
  if (Status status = folder->check_all(WorkStep::kBlocks); !status) return fail(status);
  const Result<BuildInputs> inputs = describe_inputs(plan);
  if (!inputs) return fail(inputs);
  const Result<WorkFile> signs = folder->result(WorkStep::kSigns);
  if (!signs) return fail(signs);
  const Result<SceneResult> scene = scene_of(*signs, *folder, inputs->schemas().size());
  if (!scene) return fail(scene);
  StepClock clock(progress);
  const Result<model::WriteReport> written = write_model_of(*folder, *inputs, *scene, target, *clock);
  if (!written) return fail(written);
  if (Status status = note_merged(*folder, target); !status) return fail(status);
  return MergeOutcome{false, plan.report.points_read, written->surfels, written->blocks, written->bytes};
}

}  // namespace surfcast::builder
