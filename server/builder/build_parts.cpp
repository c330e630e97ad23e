#include "builder/build_parts.h"

#include <algorithm>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <utility>

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>

#include "builder/cell_counts.h"
#include "builder/cloud_columns.h"
#include "builder/ordered_work.h"
#include "builder/spatial_order.h"
#include "scan/clean_points.h"

namespace surfcast::builder {
namespace {

size_t threads() {
  return static_cast<size_t>(oneapi::tbb::info::default_concurrency());
}

std::vector<uint64_t> codes_of(const scan::ScanPoints& points, const geometry::RootCube& root) {
  std::vector<uint64_t> codes(points.size());
  std::transform(points.positions.begin(), points.positions.end(), codes.begin(),
                 [&root](const glm::dvec3& p) { return geometry::morton_code(root, p); });
  return codes;
}

Result<std::vector<Part>> find_plan(const BuildInputs& inputs, const geometry::RootCube& root, const MemoryPlan& memory,
                                    StageClock& clock) {
  if (memory.fits_whole(inputs.size())) {
    const CountedCell all{0, 0, inputs.size()};
    return plan_parts({&all, 1}, inputs.size());
  }
  const CodePass pass = [&](const std::function<void(std::span<const uint64_t>)>& count) {
    clock.begin("counting", inputs.pieces());
    return work_in_order(inputs.pieces(), threads(), [&](size_t i) -> Result<std::function<Status()>> {
      scan::SurfelReport unused;
      const Result<InputPiece> piece = inputs.read(i, unused);
      if (!piece) return fail(piece.error());
      count(codes_of(piece->points, root));
      clock.step();
      return [] { return Status(); };
    });
  };
  const Result<std::vector<CountedCell>> cells = count_cells(pass, memory.part_points);
  if (!cells) return fail(cells.error());
  return plan_parts(*cells, memory.part_points);
}

std::vector<PartRows> sort_out(const scan::ScanPoints& points, const PartFinder& finder,
                               const geometry::RootCube& root) {
  std::map<std::pair<uint32_t, bool>, std::vector<uint32_t>> rows;
  const std::vector<uint64_t> codes = codes_of(points, root);
  for (uint32_t i = 0; i < points.size(); ++i) {
    bool own = true;
    finder.for_each_part(points.positions[i], codes[i], [&](uint32_t part) {
      rows[{part, own}].push_back(i);
      own = false;
    });
  }
  std::vector<PartRows> parts;
  parts.reserve(rows.size());
  for (auto& [key, list] : rows) parts.push_back({key.first, key.second, std::move(list)});
  return parts;
}

/// The input of each source of a single part.
std::vector<size_t> every_input(size_t inputs) {
  std::vector<size_t> all(inputs);
  std::iota(all.begin(), all.end(), size_t{0});
  return all;
}

/// Removes duplicates from the sorted points of a part. Returns for each point whether it was kept.
std::vector<uint8_t> drop_duplicates(PartPoints& points, scan::SurfelReport& report) {
  surfel::SurfelCloud& cloud = points.cloud;
  size_t& own = points.own;
  const std::vector<bool> duplicate = scan::find_duplicates(cloud);
  const auto dropped = std::count(duplicate.begin(), duplicate.begin() + static_cast<std::ptrdiff_t>(own), true);
  report.duplicates += static_cast<uint64_t>(dropped);
  own -= static_cast<size_t>(dropped);
  std::vector<bool> keep(duplicate.size());
  std::transform(duplicate.begin(), duplicate.end(), keep.begin(), std::logical_not<>());
  scan::keep_surfels(cloud, keep);
  return {keep.begin(), keep.end()};
}

/// The findings of the surfels that were kept, with an entry for each point of the part.
PartFindings spread_findings(const scan::PartSurfels& surfels, std::vector<uint32_t> order, std::vector<uint8_t> kept) {
  PartFindings findings;
  findings.order = std::move(order);
  findings.normals.resize(kept.size());
  findings.radii.resize(kept.size());
  findings.trees.resize(kept.size());
  findings.kinds.resize(kept.size());
  size_t next = 0;
  for (size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] == 0) continue;
    findings.normals[i] = surfels.cloud.normals[next];
    findings.radii[i] = surfels.estimates.radii[next];
    findings.trees[i] = surfels.trees[next];
    findings.kinds[i] = surfels.estimates.kinds[next];
    ++next;
  }
  findings.kept = std::move(kept);
  return findings;
}

}  // namespace

BuildParts::BuildParts(const BuildInputs& inputs, std::vector<Part> plan, const geometry::RootCube& root)
    : bounds_(inputs.bounds()), points_(inputs.size()), root_(root), plan_(std::move(plan)), finder_(plan_, root) {
  const bool exact = std::all_of(inputs.schemas().begin(), inputs.schemas().end(),
                                 [](const scan::ScanSchema& input) { return input.surface_step.has_value(); });
  scene_ = {bounds_, inputs.schema().z_up, inputs.schema().normals && !exact};
  for (const scan::ScanSchema& input : inputs.schemas()) {
    sensors_.push_back(input.sensor);
    surface_steps_.push_back(input.surface_step);
    exact_radii_.push_back(input.exact_radii);
    two_sided_ = two_sided_ || input.two_sided;
    names_.push_back({input.name, input.grid});
  }
}

Result<BuildParts> BuildParts::gather(const BuildInputs& inputs, const MemoryPlan& memory,
                                      const std::filesystem::path& target, StageClock& clock,
                                      scan::SurfelReport& report) {
  const geometry::RootCube root = geometry::root_cube(inputs.bounds());
  Result<std::vector<Part>> parts = find_plan(inputs, root, memory, clock);
  if (!parts) return fail(std::move(parts.error()));
  BuildParts build(inputs, std::move(*parts), root);
  clock.begin("sorting points", inputs.pieces());
  Status status =
      build.size() == 1 ? build.collect(inputs, clock, report) : build.spool(inputs, memory, target, clock, report);
  if (!status) return fail(std::move(status.error()));
  return build;
}

Status BuildParts::collect(const BuildInputs& inputs, StageClock& clock, scan::SurfelReport& report) {
  PartPoints points;
  points.cloud = empty_cloud(inputs.schema(), inputs.size());
  points.inputs = every_input(names_.size());
  for (const InputName& input : names_) points.cloud.sources.push_back({input.name, 0, 0, input.grid});
  Status status = work_in_order(inputs.pieces(), threads(), [&](size_t i) -> Result<std::function<Status()>> {
    scan::SurfelReport own;
    Result<InputPiece> piece = inputs.read(i, own);
    if (!piece) return fail(std::move(piece.error()));
    return [&, own, shared = std::make_shared<InputPiece>(std::move(*piece))] {
      report.add(own);
      copy_points(shared->points, points.own, points.cloud);
      points.own += shared->points.size();
      points.cloud.sources[shared->source].count += shared->points.size();
      clock.step();
      return Status();
    };
  });
  if (!status) return status;
  size_t first = 0;
  for (surfel::SourceRange& source : points.cloud.sources) source.first = std::exchange(first, first + source.count);
  for_each_column(points.cloud, [&](auto& values) { values.resize(points.own); });
  whole_ = std::move(points);
  return {};
}

Status BuildParts::spool(const BuildInputs& inputs, const MemoryPlan& memory, const std::filesystem::path& target,
                         StageClock& clock, scan::SurfelReport& report) {
  Result<SpoolFile> file = SpoolFile::create(target);
  if (!file) return fail(std::move(file.error()));
  store_.emplace(std::move(*file), inputs.schema(), names_, size());
  Status status = work_in_order(inputs.pieces(), threads() + 1, [&](size_t i) -> Result<std::function<Status()>> {
    scan::SurfelReport own;
    const Result<InputPiece> piece = inputs.read(i, own);
    if (!piece) return fail(piece.error());
    const std::vector<PartRows> parts = sort_out(piece->points, finder_, root_);
    return [&, own, packed = std::make_shared<PackedPiece>(pack_piece(*piece, parts))] {
      report.add(own);
      clock.step();
      return store_->add(*packed);
    };
  });
  if (!status || parts_at_once(memory) > 0) return status;
  return fail(ErrorKind::kLimit, target.string() + ": some points are too close together to be worked on in parts of " +
                                     "this memory budget");
}

size_t BuildParts::parts_at_once(const MemoryPlan& memory) const {
  if (!store_) return 1;
  uint64_t most = 1;
  for (size_t part = 0; part < size(); ++part) most = std::max(most, store_->points(part));
  return std::min(memory.parts_at_once(most), threads());
}

BuildParts::Made BuildParts::make(PartPoints points, size_t part, scan::RadiusPolicy radii) const {
  Made made;
  SpatialOrder order = spatial_order(points, root_);
  reorder(points.cloud, order.points);
  made.kept = order.distinct ? std::vector<uint8_t>(points.cloud.size(), 1) : drop_duplicates(points, made.report);
  made.own = points.own;
  if (store_) made.order = std::move(order.points);
  scan::PartFrame frame;
  frame.bounds = bounds_;
  frame.points = points_;
  frame.place = [this, part](const glm::dvec3& p) { return finder_.place(static_cast<uint32_t>(part), p); };
  for (const size_t input : points.inputs) {
    frame.sensors.push_back(sensors_[input]);
    frame.surface_steps.push_back(surface_steps_[input]);
  }
  const bool keep = std::all_of(points.inputs.begin(), points.inputs.end(),
                                [&](size_t input) { return policy_of(input, radii) == scan::RadiusPolicy::kKeep; });
  frame.inputs = std::move(points.inputs);
  frame.radii = keep ? scan::RadiusPolicy::kKeep : radii;
  made.surfels = surfcast::scan::make_surfels(std::move(points.cloud), frame, made.signs, made.report);
  return made;
}

/// Exact radii are kept unless estimates are wanted.
scan::RadiusPolicy BuildParts::policy_of(size_t input, scan::RadiusPolicy policy) const {
  return exact_radii_[input] && policy == scan::RadiusPolicy::kAuto ? scan::RadiusPolicy::kKeep : policy;
}

void BuildParts::decide_radii(const std::vector<scan::RadiusComparison>& comparisons, scan::RadiusPolicy policy,
                              scan::SurfelReport& report) {
  for (size_t input = 0; input < comparisons.size(); ++input) {
    radii_.push_back(scan::decide_radii(comparisons[input], policy_of(input, policy)));
    report.radii_estimated += radii_.back().estimated();
    report.scatter += radii_.back().scatter();
  }
}

Status BuildParts::make_surfels(const MemoryPlan& memory, scan::RadiusPolicy radii, StageClock& clock,
                                scan::SurfelReport& report) {
  clock.begin("making surfels", size());
  std::vector<scan::PartSigns> signs;
  std::vector<scan::RadiusComparison> comparisons(names_.size());
  std::vector<scan::SurfaceSample> samples;
  Status status = work_in_order(size(), parts_at_once(memory), [&](size_t part) -> Result<std::function<Status()>> {
    Result<PartPoints> points = store_ ? store_->load(part) : Result<PartPoints>(std::move(*whole_));
    if (!points) return fail(std::move(points.error()));
    const auto made = std::make_shared<Made>(make(std::move(*points), part, radii));
    return [&, part, made] {
      signs.push_back(std::move(made->signs));
      const std::vector<scan::SurfaceSample> found = std::exchange(made->surfels.samples, {});
      samples.insert(samples.end(), found.begin(), found.end());
      report.add(made->report);
      const std::vector<scan::RadiusComparison>& own = made->surfels.radii;
      for (size_t input = 0; input < own.size(); ++input) comparisons[input].add(own[input]);
      clock.step();
      if (store_)
        return store_->keep_findings(part,
                                     spread_findings(made->surfels, std::move(made->order), std::move(made->kept)));
      surfels_ = std::move(made->surfels);
      own_ = made->own;
      return Status();
    };
  });
  if (!status) return status;
  signs_ = scan::resolve_signs(signs, scene_);
  signs_.oriented = signs_.oriented && !two_sided_;
  report.oriented = signs_.oriented;
  decide_radii(comparisons, radii, report);
  spacing_.emplace(std::move(samples), bounds_);
  return {};
}

Result<BuildParts::Finished> BuildParts::take(size_t part) {
  if (!store_) {
    scan::apply_signs(signs_, part, surfels_);
    scan::apply_radii(radii_, every_input(names_.size()), surfels_.estimates, *spacing_, surfels_.cloud);
    return Finished{std::move(surfels_.cloud), own_};
  }
  Result<PartPoints> points = store_->load(part);
  if (!points) return fail(std::move(points.error()));
  Result<PartFindings> findings = store_->load_findings(part);
  if (!findings) return fail(std::move(findings.error()));
  reorder(points->cloud, findings->order);
  store_->release(part);
  scan::PartSurfels surfels;
  surfels.cloud = std::move(points->cloud);
  surfels.trees = std::move(findings->trees);
  surfels.estimates = {std::move(findings->radii), std::move(findings->kinds)};
  surfels.cloud.normals = std::move(findings->normals);
  scan::apply_signs(signs_, part, surfels);
  scan::apply_radii(radii_, points->inputs, surfels.estimates, *spacing_, surfels.cloud);
  const auto end_own = findings->kept.begin() + static_cast<std::ptrdiff_t>(points->own);
  const auto own = static_cast<size_t>(std::count(findings->kept.begin(), end_own, uint8_t{1}));
  scan::keep_surfels(surfels.cloud, {findings->kept.begin(), findings->kept.end()});
  return Finished{std::move(surfels.cloud), own};
}

}  // namespace surfcast::builder
