#include "builder/build_parts.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <string>
#include <utility>

#include <oneapi/tbb/info.h>

#include "builder/cloud_columns.h"
#include "builder/ordered_work.h"
#include "builder/spatial_order.h"
#include "estimation/clean_points.h"

namespace surfcast::builder {
namespace {

size_t threads() {
  return static_cast<size_t>(oneapi::tbb::info::default_concurrency());
}

std::vector<size_t> numbers_below(size_t count) {
  std::vector<size_t> all(count);
  std::iota(all.begin(), all.end(), size_t{0});
  return all;
}

/// The findings of the surfels that were kept, with an entry for each point of the part.
PartFindings spread_findings(const estimation::PartSurfels& surfels, std::vector<uint32_t> order,
                             std::vector<uint8_t> kept) {
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

/// Leaves the values of the points that were kept.
template <typename T>
std::vector<T> kept_values(std::vector<T> values, const std::vector<uint8_t>& kept) {
  size_t next = 0;
  for (size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] != 0) values[next++] = values[i];
  }
  values.resize(next);
  return values;
}

}  // namespace

BuildParts::BuildParts(const BuildInputs& inputs, std::vector<Part> plan)
    : frame_(std::make_unique<const BuildFrame>(inputs, std::move(plan))) {}

BuildParts::BuildParts(std::unique_ptr<const BuildFrame> frame, PartStore store)
    : frame_(std::move(frame)), store_(std::move(store)) {}

Result<BuildParts> BuildParts::gather(const BuildInputs& inputs, const Division& division,
                                      const std::filesystem::path& target, StageClock& clock,
                                      estimation::SurfelReport& report) {
  const geometry::RootCube root = geometry::root_cube(inputs.bounds());
  Result<std::vector<Part>> parts = divide_points(inputs, root, division, clock, {});
  if (!parts) return fail(parts);
  BuildParts build(inputs, std::move(*parts));
  Status status =
      build.size() == 1 ? build.collect(inputs, clock, report) : build.spool(inputs, division, target, clock, report);
  if (!status) return fail(status);
  return build;
}

Status BuildParts::collect(const BuildInputs& inputs, StageClock& clock, estimation::SurfelReport& report) {
  clock.begin("sorting points", inputs.pieces());
  PartPoints points;
  points.cloud = empty_cloud(inputs.schema(), inputs.size());
  points.inputs = numbers_below(frame_->names.size());
  for (const InputName& input : frame_->names) points.cloud.sources.push_back({input.name, 0, 0, input.grid});
  Status status = work_in_order(inputs.pieces(), threads(), [&](size_t i) -> Result<std::function<Status()>> {
    estimation::SurfelReport own;
    Result<InputPiece> piece = inputs.read(i, own);
    if (!piece) return fail(piece);
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

Status BuildParts::spool(const BuildInputs& inputs, const Division& division, const std::filesystem::path& target,
                         StageClock& clock, estimation::SurfelReport& report) {
  Result<SpoolFile> file = SpoolFile::create(target);
  if (!file) return fail(file);
  store_.emplace(std::move(*file), inputs.schema(), frame_->names, size());
  Status status = distribute_points(inputs, numbers_below(inputs.pieces()), frame_->finder, frame_->root, {}, *store_,
                                    clock, report);
  if (!status || parts_at_once(division.memory) > 0) return status;
  return fail(ErrorKind::kLimit,
              target.string() + (division.parts ? ": so few parts do not fit into this memory budget"
                                                : ": some points are too close together to be worked on in parts of "
                                                  "this memory budget"));
}

size_t BuildParts::parts_at_once(const MemoryPlan& memory) const {
  if (!store_) return 1;
  uint64_t most = 1;
  for (size_t part = 0; part < size(); ++part) most = std::max(most, store_->points(part));
  return std::min(memory.parts_at_once(most), threads());
}

Status BuildParts::make_surfels(const MemoryPlan& memory, estimation::RadiusPolicy radii, StageClock& clock,
                                estimation::SurfelReport& report) {
  clock.begin("making surfels", size());
  SceneEvidence evidence(frame_->names.size());
  Status status = work_in_order(size(), parts_at_once(memory), [&](size_t part) -> Result<std::function<Status()>> {
    Result<PartPoints> points = store_ ? store_->load(part) : Result<PartPoints>(std::move(*whole_));
    if (!points) return fail(points);
    const auto made =
        std::make_shared<MadePart>(make_part(*frame_, std::move(*points), part, radii, store_.has_value()));
    return [&, part, made] {
      evidence.add(std::move(made->signs), made->surfels.radii, made->surfels.samples);
      report.add(made->report);
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
  decisions_ = evidence.decide(*frame_, radii, report);
  spacing_.emplace(std::move(evidence).take_samples(), frame_->bounds);
  return {};
}

Result<FinishedPart> BuildParts::take(size_t part) {
  if (!store_) {
    settle_surfels(decisions_, *spacing_, part, numbers_below(frame_->names.size()), surfels_);
    return FinishedPart{std::move(surfels_.cloud), own_};
  }
  Result<PartPoints> points = store_->load(part);
  if (!points) return fail(points);
  Result<PartFindings> findings = store_->load_findings(part);
  if (!findings) return fail(findings);
  reorder(points->cloud, findings->order);
  store_->release(part);
  const std::vector<uint8_t>& kept = findings->kept;
  estimation::PartSurfels surfels;
  surfels.cloud = std::move(points->cloud);
  surfels.cloud.normals = std::move(findings->normals);
  estimation::keep_surfels(surfels.cloud, {kept.begin(), kept.end()});
  surfels.trees = kept_values(std::move(findings->trees), kept);
  surfels.estimates = {kept_values(std::move(findings->radii), kept), kept_values(std::move(findings->kinds), kept)};
  settle_surfels(decisions_, *spacing_, part, points->inputs, surfels);
  const auto end_own = kept.begin() + static_cast<std::ptrdiff_t>(points->own);
  const auto own = static_cast<size_t>(std::count(kept.begin(), end_own, uint8_t{1}));
  return FinishedPart{std::move(surfels.cloud), own};
}

}  // namespace surfcast::builder
