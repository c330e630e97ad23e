#include "builder/append_model.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/spool_file.h"
#include "builder/append_checks.h"
#include "builder/append_inputs.h"
#include "builder/append_steps.h"
#include "builder/build_checks.h"
#include "builder/cloud_columns.h"
#include "builder/model_properties.h"
#include "builder/ordered_work.h"
#include "grid/open_scan.h"
#include "ldc/coarse_surfel.h"
#include "scan/merge_schemas.h"

namespace surfcast::builder {
namespace {

namespace fs = std::filesystem;

std::string text_of_system(const model::CoordinateSystem& system) {
  return system.wkt.empty() ? system.id : system.wkt;
}

/// Brings the scans into the system of the model.
Result<Placement> place_in(const model::Georeference& georeference, const SystemOptions& wanted, const fs::path& model,
                           std::span<const fs::path> paths, BuildInputs& inputs) {
  if (!georeference.known()) {
    for (size_t i = 0; i < paths.size(); ++i) {
      if (inputs.schemas()[i].crs.empty() && wanted.assigned.empty()) continue;
      return refuse_append(paths[i], "has a coordinate system, and " + model.filename().string() + " has none");
    }
    return Placement();
  }
  SystemOptions systems = wanted;
  systems.target = text_of_system(georeference.system);
  if (systems.assigned.empty()) {
    systems.assigned = text_of_system(georeference.source.known() ? georeference.source : georeference.system);
  }
  Result<Placement> placement = inputs.place(systems);
  if (!placement) return fail_about(paths.front().string(), placement);
  return placement;
}

geometry::Box all_bounds(const model::ModelFile& model, const BuildInputs& added) {
  geometry::Box all = model.info().bounds;
  all.include(added.bounds());
  return all;
}

/// The octree of the model, as large as all points need it.
Result<GrownRoot> grown_root(const model::ModelFile& model, const BuildInputs& added, const fs::path& first_input) {
  const geometry::Box all = all_bounds(model, added);
  const uint32_t top = model.tree().roots().front();
  if (is_leaf(model, top)) return GrownRoot{geometry::root_cube(all), {}};
  const Result<model::StoredBlock> stored = model.stored(top);
  if (!stored) return fail(stored);
  const std::optional<geometry::RootCube> root = root_of(model.blocks(), stored->grid);
  if (!root || model.tree().roots().size() != 1) {
    return refuse_append(model.path(), "cannot be added to, because its blocks lie in no cube");
  }
  int deepest = 0;
  for (const ldc::BlockEntry& block : model.blocks()) deepest = std::max<int>(deepest, block.key.depth);
  const std::optional<GrownRoot> grown = grow_root(*root, all, deepest);
  if (grown) return *grown;
  return refuse_append(first_input, "is too far away from " + model.path().filename().string() + " to be added to it");
}

/// Where the new points lie.
Result<NewPoints> find_places(const BuildInputs& added, const geometry::RootCube& root, StageClock& clock) {
  NewPoints places(root);
  clock.begin("counting", added.pieces());
  const Status status =
      work_in_order(added.pieces(), append_threads(), [&](size_t i) -> Result<std::function<Status()>> {
        estimation::SurfelReport report;
        const Result<InputPiece> piece = added.read(i, report);
        if (!piece) return fail(piece);
        auto own = std::make_shared<NewPoints>(root);
        own->add(piece->points.positions);
        return [&, own] {
          places.add(*own);
          clock.step();
          return Status();
        };
      });
  if (!status) return fail(status);
  return places;
}

/// The leaves that are copied.
std::vector<uint32_t> kept_leaves(const model::ModelFile& model, const AppendPlan& plan) {
  std::vector<uint32_t> leaves = leaves_of(model);
  std::erase_if(leaves, [&plan](uint32_t leaf) { return plan.region_of[leaf] != AppendPlan::kNoRegion; });
  return leaves;
}

/// Statistics of the leaves that are copied. Ranges and classes follow from the tables of the model. The frequencies of
/// intensities are not stored: they are counted in at most 64 blocks, spread over the model.
Result<model::AttributeStatistics> kept_statistics(const model::ModelFile& model, const AppendPlan& plan,
                                                   const model::AttributeStatistics& given_up) {
  constexpr size_t kSampledBlocks = 64;
  const model::ModelInfo& info = model.info();
  model::AttributeStatistics kept(info.scalar_names, info.ranges, info.classes);
  kept.take_classes(given_up);
  if (info.range_of("intensity") == nullptr) return kept;
  const std::vector<uint32_t> leaves = kept_leaves(model, plan);
  const size_t samples = std::min(kSampledBlocks, leaves.size());
  for (size_t i = 0; i < samples; ++i) {
    Result<model::DecodedBlock> block = model.decode(leaves[i * leaves.size() / samples], model::WantedScalars::kDrawn);
    if (!block) return fail(block);
    kept.add_intensities(statistics_of(std::move(*block), info),
                         static_cast<double>(leaves.size()) / static_cast<double>(samples));
  }
  return kept;
}

/// A cloud without surfels that has the common properties of all clouds of the model.
surfel::SurfelCloud common_cloud_of(const AppendInputs& inputs) {
  scan::ScanSchema schema = inputs.schema;
  schema.scalars.resize(schema.scalars.size() - 2);  // without the columns of former points
  surfel::SurfelCloud common = empty_cloud(schema, 0);
  common.oriented = inputs.model.info().oriented;
  common.z_up = inputs.model.info().z_up;
  for (const std::string& name : inputs.model.info().source_names) common.sources.push_back({name, 0, 0, {}});
  for (const scan::ScanSchema& input : inputs.added.schemas()) common.sources.push_back({input.name, 0, 0, {}});
  return common;
}

/// Bytes of the surfels of the topmost blocks that are copied, from which the levels above are made.
uint64_t bytes_of_front(const model::ModelFile& model, const AppendPlan& plan) {
  uint64_t surfels = 0;
  for (const uint32_t block : plan.kept) surfels += model.blocks()[block].items;
  return surfels * sizeof(ldc::CoarseSurfel);
}

Status append_points(const AppendInputs& inputs, const AppendOptions& options, StageClock& clock, BuildReport& report) {
  const fs::path& target = inputs.model.path();
  const auto memory_for = [&](uint64_t held) {
    return plan_memory(report.memory_budget, held, inputs.schema).map_error([&](const Error& error) {
      return Error{error.kind, target.string() + ": " + error.message};
    });
  };
  Result<MemoryPlan> memory = memory_for(inputs.added.held_bytes());
  if (!memory) return fail(memory);
  const uint64_t limit = options.part_points.value_or(memory->part_points);
  const AppendPlan plan = plan_append(inputs.model.tree(), inputs.root, inputs.places, limit);
  memory = memory_for(inputs.added.held_bytes() + bytes_of_front(inputs.model, plan));
  if (!memory) return fail(memory);

  auto frame = std::make_unique<const BuildFrame>(inputs.added, inputs.former.lattices, inputs.root.root,
                                                  all_bounds(inputs.model, inputs.added), inputs.model.info().oriented,
                                                  plan.regions);
  Result<SpoolFile> spool = SpoolFile::create(target);
  if (!spool) return fail(spool);
  PartStore store(std::move(*spool), inputs.schema, frame->names, frame->parts.size());
  const Result<model::AttributeStatistics> given_up =
      distribute_points(inputs, plan, *frame, store, clock, report.scan);
  if (!given_up) return fail(given_up);
  BuildParts parts(std::move(frame), std::move(store));
  if (parts.parts_at_once(*memory) == 0) {
    return fail(ErrorKind::kLimit, target.string() +
                                       ": some points are too close together to be worked on in parts of "
                                       "this memory budget");
  }
  report.parts = parts.size();
  if (Status made = parts.make_surfels(*memory, options.radii, clock, report.scan); !made) return made;
  report.radii = radii_of(inputs.added.schemas(), parts.radii().subspan(inputs.former.lattices.size()));

  const Result<model::AttributeStatistics> statistics = kept_statistics(inputs.model, plan, *given_up);
  if (!statistics) return fail(statistics);
  const surfel::SurfelCloud common = common_cloud_of(inputs);
  Result<model::ModelWriter> writer = model::ModelWriter::create(target, model::schema_of(common));
  if (!writer) return fail(writer);
  writer->set_georeference(report.georeference);
  writer->add_statistics(*statistics);
  const Result<uint64_t> copied = write_grown_blocks(inputs, plan, parts, *memory, options, common, clock, *writer);
  if (!copied) return fail(copied);
  const Result<model::WriteReport> written = writer->finish();
  if (!written) return fail(written);
  report.surfels = written->surfels;
  report.blocks = written->blocks;
  report.bytes = written->bytes;
  report.appended = AppendedBlocks{inputs.model.info().surfels, *copied};
  return {};
}

Status append_scans(std::span<const fs::path> paths, const model::ModelFile& model, const AppendOptions& options,
                    StageClock& clock, BuildReport& report) {
  clock.begin("reading", paths.size());
  const OpenInput open = [&options](const fs::path& input, const scan::DecodingLimit& limit,
                                    std::optional<uint64_t> sample) {
    return grid::open_scan(input, limit, sample, options.selection);
  };
  Result<BuildInputs> added =
      BuildInputs::open(paths, open, model.info().z_up, report.memory_budget, {}, [&clock](double) { clock.step(); });
  if (!added) return fail(added);
  const Result<model::Georeference> georeference = model.georeference();
  if (!georeference) return fail(georeference);
  Result<Placement> placement = place_in(*georeference, options.systems, model.path(), paths, *added);
  if (!placement) return fail(placement);
  report.points_in_scans = added->size_of_files();
  report.transformed = std::move(placement->transformed);
  report.georeference = *georeference;
  clock.know_points(added->size());
  if (Status status = check_bounds(added->bounds(), paths.front()); !status) return status;
  const scan::ScanSchema own = schema_of_points(model);
  if (Status status = check_added_columns(*added, paths, own); !status) return status;
  scan::ScanSchema schema = scan::merge_schemas(std::vector{own, added->schema()});
  report.scan.notes = scan::describe_fillings(added->schemas(), schema);
  report.scan.notes.insert(report.scan.notes.end(), placement->notes.begin(), placement->notes.end());
  add_former_columns(schema);
  Result<FormerModel> former = former_model(model, leaves_of(model));
  if (!former) return fail(former);
  const Result<GrownRoot> root = grown_root(model, *added, paths.front());
  if (!root) return fail(root);
  Result<NewPoints> places = find_places(*added, root->root, clock);
  if (!places) return fail(places);
  return append_points({model, *added, std::move(schema), std::move(*former), *root, std::move(*places)}, options,
                       clock, report);
}

}  // namespace

Result<BuildReport> append_to_model(std::span<const fs::path> inputs, const fs::path& path,
                                    const AppendOptions& options, const BuildProgress& progress) {
  const Stopwatch stopwatch;
  BuildReport report;
  if (Status status = check_target(path, inputs); !status) return fail(status);
  const Result<uint64_t> budget = memory_budget(options.memory);
  if (!budget) return fail_about(path.string(), budget);
  report.memory_budget = *budget;
  const Result<model::ModelFile> model = model::ModelFile::open(path);
  if (!model) return fail(model);
  Status status = check_grown_model(*model);
  if (status) status = check_added_scans(inputs);
  if (!status) return fail(status);
  {
    StageClock clock(progress, report);
    status = append_scans(inputs, *model, options, clock, report);
  }
  if (!status) return fail(status);
  report.seconds = stopwatch.seconds();
  report.peak_memory = peak_resident_bytes();
  return report;
}

}  // namespace surfcast::builder
