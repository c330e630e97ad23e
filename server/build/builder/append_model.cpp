#include "builder/append_model.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <oneapi/tbb/info.h>

#include "base/spool_file.h"
#include "builder/append_plan.h"
#include "builder/build_checks.h"
#include "builder/build_inputs.h"
#include "builder/build_parts.h"
#include "builder/cloud_columns.h"
#include "builder/former_points.h"
#include "builder/input_files.h"
#include "builder/memory_budget.h"
#include "builder/model_properties.h"
#include "builder/ordered_work.h"
#include "builder/part_blocks.h"
#include "builder/stage_clock.h"
#include "grid/open_scan.h"
#include "ldc/coarse_scalars.h"
#include "model/block_decoder.h"
#include "model/model_file.h"
#include "model/model_writer.h"
#include "model/write_blocks.h"
#include "scan/merge_schemas.h"
#include "surfel/curvature.h"

namespace surfcast::builder {
namespace {

namespace fs = std::filesystem;

size_t threads_at_hand() {
  return static_cast<size_t>(oneapi::tbb::info::default_concurrency());
}

tl::unexpected<Error> refusal(const fs::path& subject, const std::string& why) {
  return fail(ErrorKind::kUnsupported, subject.string() + ": " + why);
}

// ---- what can be appended to what

Status check_model(const model::ModelFile& model) {
  const model::ModelInfo& info = model.info();
  const bool surfels = info.kinds.size() == 1 && info.kinds.front().kind == model::kSurfelKind;
  if (!surfels) return refusal(model.path(), "cannot be added to, because it holds more than surfels");
  if (info.even) return refusal(model.path(), "cannot be added to, because it is made of meshes");
  for (const model::ScalarColumn& scalar : model.scalars()) {
    if (surfel::is_curvature_column(scalar.name)) {
      return refusal(model.path(), "cannot be added to, because it is simplified");
    }
    if (scalar.coarse != ldc::is_coarse_scalar(scalar.name)) {
      return refusal(model.path(), "cannot be added to, because an older program made it; build it anew");
    }
  }
  return {};
}

Status check_scans(std::span<const fs::path> inputs) {
  for (const fs::path& input : inputs) {
    if (kind_of_input(input) != InputKind::kScan) {
      return refusal(input, "only scans can be added to a model, and this is none");
    }
  }
  return {};
}

/// What a scan has that the model lacks; empty: nothing.
std::string surplus_of(const scan::ScanSchema& input, const scan::ScanSchema& model) {
  if (input.color_bits > model.color_bits) return model.color_bits == 0 ? "colours" : "colours of 16 bits";
  for (const scan::ScalarField& field : input.scalars) {
    const auto known = std::ranges::find(model.scalars, field.name, &scan::ScalarField::name);
    if (known == model.scalars.end()) return "the attribute " + field.name;
    const scan::ScanSchema both = scan::merge_schemas(std::vector{model, input});
    const auto merged = std::ranges::find(both.scalars, field.name, &scan::ScalarField::name);
    if (merged->type != known->type) return "larger numbers of the attribute " + field.name;
  }
  return {};
}

Status check_columns(const BuildInputs& inputs, std::span<const fs::path> paths, const scan::ScanSchema& model) {
  for (size_t i = 0; i < paths.size(); ++i) {
    const std::string surplus = surplus_of(inputs.schemas()[i], model);
    if (!surplus.empty()) return refusal(paths[i], "has " + surplus + ", which " + model.name + " lacks");
  }
  return {};
}

// ---- where the scans lie

std::string text_of_system(const model::CoordinateSystem& system) {
  return system.wkt.empty() ? system.id : system.wkt;
}

/// Brings the scans into the system of the model.
Result<Placement> place_in(const model::Georeference& georeference, const SystemOptions& wanted, const fs::path& model,
                           std::span<const fs::path> paths, BuildInputs& inputs) {
  if (!georeference.known()) {
    for (size_t i = 0; i < paths.size(); ++i) {
      if (inputs.schemas()[i].crs.empty() && wanted.assigned.empty()) continue;
      return refusal(paths[i], "has a coordinate system, and " + model.filename().string() + " has none");
    }
    return Placement();
  }
  SystemOptions systems = wanted;
  systems.target = text_of_system(georeference.system);
  if (systems.assigned.empty()) {
    systems.assigned = text_of_system(georeference.source.known() ? georeference.source : georeference.system);
  }
  Result<Placement> placement = inputs.place(systems);
  if (!placement) return fail(placement.error().kind, paths.front().string() + ": " + placement.error().message);
  return placement;
}

// ---- the work

struct AppendInputs {
  const model::ModelFile& model;
  const BuildInputs& added;
  scan::ScanSchema schema;  ///< of all points, with the columns of former ones
  FormerModel former;
  GrownRoot root;
  NewPoints places;
};

bool is_leaf(const model::ModelFile& model, uint32_t block) {
  return model.tree().children(block).count == 0;
}

std::vector<uint32_t> leaves_of(const model::ModelFile& model) {
  std::vector<uint32_t> leaves;
  for (uint32_t block = 0; block < model.blocks().size(); ++block) {
    if (is_leaf(model, block)) leaves.push_back(block);
  }
  return leaves;
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
  if (!stored) return fail(stored.error());
  const std::optional<geometry::RootCube> root = root_of(model.blocks(), stored->grid);
  if (!root || model.tree().roots().size() != 1) {
    return refusal(model.path(), "cannot be added to, because its blocks lie in no cube");
  }
  int deepest = 0;
  for (const ldc::BlockEntry& block : model.blocks()) deepest = std::max<int>(deepest, block.key.depth);
  const std::optional<GrownRoot> grown = grow_root(*root, all, deepest);
  if (grown) return *grown;
  return refusal(first_input, "is too far away from " + model.path().filename().string() + " to be added to it");
}

/// Where the new points lie.
Result<NewPoints> find_places(const BuildInputs& added, const geometry::RootCube& root, StageClock& clock) {
  NewPoints places(root);
  clock.begin("counting", added.pieces());
  const Status status =
      work_in_order(added.pieces(), threads_at_hand(), [&](size_t i) -> Result<std::function<Status()>> {
        estimation::SurfelReport report;
        const Result<InputPiece> piece = added.read(i, report);
        if (!piece) return fail(piece.error());
        auto own = std::make_shared<NewPoints>(root);
        own->add(piece->points.positions);
        return [&, own] {
          places.add(*own);
          clock.step();
          return Status();
        };
      });
  if (!status) return fail(status.error());
  return places;
}

/// The rows of some points by the parts that need them. `own`: each of them belongs to a part, the nearest one where
/// rounding moved it out of all.
std::vector<PartRows> rows_by_part(const scan::ScanPoints& points, const BuildFrame& frame, bool own) {
  std::map<std::pair<uint32_t, bool>, std::vector<uint32_t>> rows;
  for (uint32_t i = 0; i < points.size(); ++i) {
    const glm::dvec3& p = points.positions[i];
    const uint64_t code = geometry::morton_code(frame.root, p);
    uint32_t part = own ? frame.finder.part_of(code) : PartFinder::kNoPart;
    if (own && part == PartFinder::kNoPart) part = frame.finder.nearest_part(p);
    if (own) rows[{part, true}].push_back(i);
    frame.finder.for_each_halo(p, code, part, [&](uint32_t near) { rows[{near, false}].push_back(i); });
  }
  std::vector<PartRows> parts;
  parts.reserve(rows.size());
  for (auto& [key, list] : rows) parts.push_back({key.first, key.second, std::move(list)});
  return parts;
}

/// Distributes former and new points to the regions, and counts what former leaves give up.
class Distribution {
 public:
  Distribution(const AppendInputs& inputs, const AppendPlan& plan, const BuildFrame& frame, PartStore& store)
      : inputs_(inputs), plan_(plan), frame_(frame), store_(store) {}

  Status add_all(StageClock& clock, estimation::SurfelReport& report) {
    const std::vector<uint32_t> leaves = needed_leaves();
    clock.begin("sorting points", leaves.size() + inputs_.added.pieces());
    Status status =
        work_in_order(leaves.size(), threads_at_hand(), [&](size_t i) { return add_leaf(leaves[i], clock); });
    if (!status) return status;
    return work_in_order(inputs_.added.pieces(), threads_at_hand(),
                         [&](size_t i) { return add_piece(i, clock, report); });
  }

  /// Statistics of the former leaves that are made anew.
  [[nodiscard]] const model::AttributeStatistics& given_up() const { return given_up_; }

 private:
  using Step = Result<std::function<Status()>>;

  /// Those that are made anew, and those with points near them.
  [[nodiscard]] std::vector<uint32_t> needed_leaves() const {
    std::vector<uint32_t> needed;
    for (const uint32_t leaf : leaves_of(inputs_.model)) {
      bool need = plan_.region_of[leaf] != AppendPlan::kNoRegion;
      for (uint32_t part = 0; part < frame_.parts.size() && !need; ++part) {
        need = frame_.finder.may_need(part, inputs_.model.blocks()[leaf].bounds);
      }
      if (need) needed.push_back(leaf);
    }
    return needed;
  }

  Step add_leaf(uint32_t leaf, StageClock& clock) {
    Result<model::DecodedBlock> block = inputs_.model.decode(leaf);
    if (!block) return fail(block.error());
    const bool own = plan_.region_of[leaf] != AppendPlan::kNoRegion;
    const double spacing = inputs_.model.blocks()[leaf].spacing;
    const auto is_affected = [&](const glm::dvec3& position, float radius) {
      const double reach = kReachOverRadius * std::max(spacing, double{radius});
      return own && inputs_.places.any_near({position, position}, reach);
    };
    model::AttributeStatistics statistics;
    if (own) statistics = statistics_of(*block, inputs_.model.info());
    const InputPiece piece{lattice_of(block->grid, inputs_.former),
                           points_of_leaf(std::move(*block), inputs_.model.info().color_bits, inputs_.former,
                                          inputs_.schema, is_affected)};
    const std::vector<PartRows> rows = rows_by_part(piece.points, frame_, own);
    return [this, &clock, statistics = std::move(statistics),
            packed = std::make_shared<PackedPiece>(pack_piece(piece, rows))] {
      given_up_.add(statistics);
      clock.step();
      return store_.add(*packed);
    };
  }

  Step add_piece(size_t number, StageClock& clock, estimation::SurfelReport& report) {
    estimation::SurfelReport own;
    Result<InputPiece> piece = inputs_.added.read(number, own);
    if (!piece) return fail(std::move(piece.error()));
    piece->source += inputs_.former.lattices.size();
    piece->points = scan::conform(std::move(piece->points), inputs_.schema);
    const std::vector<PartRows> rows = rows_by_part(piece->points, frame_, true);
    return [this, &clock, &report, own, packed = std::make_shared<PackedPiece>(pack_piece(*piece, rows))] {
      report.add(own);
      clock.step();
      return store_.add(*packed);
    };
  }

  const AppendInputs& inputs_;
  const AppendPlan& plan_;
  const BuildFrame& frame_;
  PartStore& store_;
  model::AttributeStatistics given_up_;
};

/// Writes the grown model.
class AppendPass {
 public:
  AppendPass(const AppendInputs& inputs, const AppendPlan& plan, model::ModelWriter& writer)
      : inputs_(inputs), plan_(plan), writer_(writer) {}

  Status copy_kept(StageClock& clock) {
    clock.begin("copying blocks", plan_.kept.size());
    for (const uint32_t block : plan_.kept) {
      const Result<uint32_t> number = copy(block);
      if (!number) return fail(number.error());
      Result<model::DecodedBlock> decoded = inputs_.model.decode(block);
      if (!decoded) return fail(std::move(decoded.error()));
      const uint32_t parent = inputs_.model.blocks()[block].parent;
      std::optional<ldc::OctreeKey> parent_key;
      if (parent != ldc::BlockEntry::kNoParent) parent_key = key_of(parent);
      for (ldc::FrontCell& cell : front_of_kept(std::move(*decoded), inputs_.model, is_leaf(inputs_.model, block),
                                                key_of(block), parent_key, inputs_.root.root, *number)) {
        front_.push_back(std::move(cell));
      }
      clock.step();
    }
    return {};
  }

  Status write_regions(BuildParts& parts, const MemoryPlan& memory, const AppendOptions& options, StageClock& clock) {
    clock.begin("writing blocks", parts.size());
    const bool new_normals = inputs_.added.schema().normals || inputs_.former.stated_normals;
    return work_in_order(
        parts.size(), parts.parts_at_once(memory), [&](size_t part) -> Result<std::function<Status()>> {
          Result<FinishedPart> surfels = parts.take(part);
          if (!surfels) return fail(std::move(surfels.error()));
          restore_former(surfels->cloud);
          surfels->cloud.estimated_normals = !new_normals;
          surfels->cloud.estimated_radii = surfels->cloud.estimated_radii && !inputs_.former.stated_radii;
          auto blocks = std::make_shared<PartBlocks>(
              make_part_blocks(std::move(*surfels), parts.plan(part), parts.root(), options.precision));
          return [this, &clock, blocks] {
            clock.step();
            return write(*blocks);
          };
        });
  }

  Status write_levels_above(const surfel::SurfelCloud& common) {
    const std::vector<ldc::TreeBlock> blocks = ldc::build_levels_above(
        std::move(front_), inputs_.root.root, ldc::coarse_attributes(common), static_cast<uint32_t>(blocks_));
    return model::write_blocks(writer_, common, blocks, {});
  }

  [[nodiscard]] uint64_t copied() const { return copied_; }

 private:
  [[nodiscard]] ldc::OctreeKey key_of(uint32_t block) const {
    return inputs_.root.key_of(inputs_.model.blocks()[block].key);
  }

  /// Copies a block after those below it.
  Result<uint32_t> copy(uint32_t block) {
    std::vector<uint32_t> children;
    const auto [first, count] = inputs_.model.tree().children(block);
    for (uint32_t child = first; child < first + count; ++child) {
      Result<uint32_t> number = copy(child);
      if (!number) return number;
      children.push_back(*number);
    }
    const Result<model::StoredBlock> stored = inputs_.model.stored(block);
    if (!stored) return fail(stored.error());
    const ldc::BlockEntry& entry = inputs_.model.blocks()[block];
    model::EncodedBlock same;
    same.bytes.assign(stored->bytes.begin(), stored->bytes.end());
    same.grid = stored->grid;
    same.origin = stored->origin;
    same.extent = stored->extent;
    same.surfels = stored->items;
    same.scatter = stored->scatter;
    same.spacing = static_cast<float>(entry.spacing);
    same.max_radius = static_cast<float>(entry.max_radius);
    same.normals = entry.normals;
    ++blocks_;
    ++copied_;
    return writer_.add(same, key_of(block), children);
  }

  Status write(PartBlocks& part) {
    renumber(static_cast<uint32_t>(blocks_), part.subtree);
    blocks_ += part.subtree.blocks.size();
    for (ldc::FrontCell& cell : part.subtree.front) front_.push_back(std::move(cell));
    return model::write_blocks(writer_, part.cloud, part.subtree.blocks, {});
  }

  const AppendInputs& inputs_;
  const AppendPlan& plan_;
  model::ModelWriter& writer_;
  size_t blocks_ = 0;
  uint64_t copied_ = 0;
  ldc::Front front_;
};

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
    if (!block) return fail(std::move(block.error()));
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
  for (const uint32_t block : plan.kept) surfels += model.blocks()[block].surfels;
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
  if (!memory) return fail(std::move(memory.error()));
  const uint64_t limit = options.part_points.value_or(memory->part_points);
  const AppendPlan plan = plan_append(inputs.model.tree(), inputs.root, inputs.places, limit);
  memory = memory_for(inputs.added.held_bytes() + bytes_of_front(inputs.model, plan));
  if (!memory) return fail(std::move(memory.error()));

  auto frame = std::make_unique<const BuildFrame>(inputs.added, inputs.former.lattices, inputs.root.root,
                                                  all_bounds(inputs.model, inputs.added), inputs.model.info().oriented,
                                                  plan.regions);
  Result<SpoolFile> spool = SpoolFile::create(target);
  if (!spool) return fail(std::move(spool.error()));
  PartStore store(std::move(*spool), inputs.schema, frame->names, frame->parts.size());
  Distribution distribution(inputs, plan, *frame, store);
  if (Status status = distribution.add_all(clock, report.scan); !status) return status;
  BuildParts parts(std::move(frame), std::move(store));
  if (parts.parts_at_once(*memory) == 0) {
    return fail(ErrorKind::kLimit, target.string() +
                                       ": some points are too close together to be worked on in parts of "
                                       "this memory budget");
  }
  report.parts = parts.size();
  if (Status made = parts.make_surfels(*memory, options.radii, clock, report.scan); !made) return made;
  report.radii = radii_of(inputs.added.schemas(), parts.radii().subspan(inputs.former.lattices.size()));

  const Result<model::AttributeStatistics> statistics = kept_statistics(inputs.model, plan, distribution.given_up());
  if (!statistics) return fail(statistics.error());
  const surfel::SurfelCloud common = common_cloud_of(inputs);
  Result<model::ModelWriter> writer = model::ModelWriter::create(target, model::schema_of(common));
  if (!writer) return fail(std::move(writer.error()));
  writer->set_georeference(report.georeference);
  writer->add_statistics(*statistics);
  AppendPass pass(inputs, plan, *writer);
  Status status = pass.copy_kept(clock);
  if (status) status = pass.write_regions(parts, *memory, options, clock);
  clock.begin("writing levels above", 1);
  if (status) status = pass.write_levels_above(common);
  if (!status) return status;
  const Result<model::WriteReport> written = writer->finish();
  if (!written) return fail(written.error());
  report.surfels = written->surfels;
  report.blocks = written->blocks;
  report.bytes = written->bytes;
  report.appended = AppendedBlocks{inputs.model.info().surfels, pass.copied()};
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
  if (!added) return fail(std::move(added.error()));
  const Result<model::Georeference> georeference = model.georeference();
  if (!georeference) return fail(georeference.error());
  Result<Placement> placement = place_in(*georeference, options.systems, model.path(), paths, *added);
  if (!placement) return fail(std::move(placement.error()));
  report.points_in_scans = added->size_of_files();
  report.transformed = std::move(placement->transformed);
  report.georeference = *georeference;
  clock.know_points(added->size());
  if (Status status = check_bounds(added->bounds(), paths.front()); !status) return status;
  const scan::ScanSchema own = schema_of_points(model);
  if (Status status = check_columns(*added, paths, own); !status) return status;
  scan::ScanSchema schema = scan::merge_schemas(std::vector{own, added->schema()});
  report.scan.notes = scan::describe_fillings(added->schemas(), schema);
  report.scan.notes.insert(report.scan.notes.end(), placement->notes.begin(), placement->notes.end());
  add_former_columns(schema);
  Result<FormerModel> former = former_model(model, leaves_of(model));
  if (!former) return fail(std::move(former.error()));
  const Result<GrownRoot> root = grown_root(model, *added, paths.front());
  if (!root) return fail(root.error());
  Result<NewPoints> places = find_places(*added, root->root, clock);
  if (!places) return fail(std::move(places.error()));
  return append_points({model, *added, std::move(schema), std::move(*former), *root, std::move(*places)}, options,
                       clock, report);
}

}  // namespace

Result<BuildReport> append_to_model(std::span<const fs::path> inputs, const fs::path& path,
                                    const AppendOptions& options, const BuildProgress& progress) {
  const Stopwatch stopwatch;
  BuildReport report;
  if (Status status = check_target(path, inputs); !status) return fail(std::move(status.error()));
  const Result<uint64_t> budget = memory_budget(options.memory);
  if (!budget) return fail(budget.error().kind, path.string() + ": " + budget.error().message);
  report.memory_budget = *budget;
  const Result<model::ModelFile> model = model::ModelFile::open(path);
  if (!model) return fail(model.error());
  Status status = check_model(*model);
  if (status) status = check_scans(inputs);
  if (!status) return fail(std::move(status.error()));
  {
    StageClock clock(progress, report);
    status = append_scans(inputs, *model, options, clock, report);
  }
  if (!status) return fail(std::move(status.error()));
  report.seconds = stopwatch.seconds();
  report.peak_memory = peak_resident_bytes();
  return report;
}

}  // namespace surfcast::builder
