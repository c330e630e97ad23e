#include "builder/make_part.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "builder/spatial_order.h"
#include "estimation/clean_points.h"

namespace surfcast::builder {
namespace {

/// Removes duplicates from the sorted points of a part. Returns for each point whether it was kept.
std::vector<uint8_t> drop_duplicates(PartPoints& points, estimation::SurfelReport& report) {
  surfel::SurfelCloud& cloud = points.cloud;
  size_t& own = points.own;
  const std::vector<bool> duplicate = estimation::find_duplicates(cloud);
  const auto dropped = std::count(duplicate.begin(), duplicate.begin() + static_cast<std::ptrdiff_t>(own), true);
  report.duplicates += static_cast<uint64_t>(dropped);
  own -= static_cast<size_t>(dropped);
  std::vector<bool> keep(duplicate.size());
  std::transform(duplicate.begin(), duplicate.end(), keep.begin(), std::logical_not<>());
  estimation::keep_surfels(cloud, keep);
  return {keep.begin(), keep.end()};
}

/// Exact radii are kept unless estimates are wanted.
estimation::RadiusPolicy policy_of(const BuildFrame& frame, size_t input, estimation::RadiusPolicy policy) {
  return frame.exact_radii[input] && policy == estimation::RadiusPolicy::kAuto ? estimation::RadiusPolicy::kKeep
                                                                               : policy;
}

/// The part in relation to the whole.
estimation::PartFrame frame_of(const BuildFrame& frame, std::vector<size_t> inputs, size_t part,
                               estimation::RadiusPolicy radii) {
  estimation::PartFrame own;
  own.bounds = frame.bounds;
  own.points = frame.points;
  own.place = [&frame, part](const glm::dvec3& p) { return frame.finder.place(static_cast<uint32_t>(part), p); };
  for (const size_t input : inputs) {
    own.sensors.push_back(frame.sensors[input]);
    own.surface_steps.push_back(frame.surface_steps[input]);
  }
  const bool keep = std::all_of(inputs.begin(), inputs.end(), [&](size_t input) {
    return policy_of(frame, input, radii) == estimation::RadiusPolicy::kKeep;
  });
  own.inputs = std::move(inputs);
  own.radii = keep ? estimation::RadiusPolicy::kKeep : radii;
  return own;
}

}  // namespace

BuildFrame::BuildFrame(const BuildInputs& inputs, std::vector<Part> plan)
    : bounds(inputs.bounds()),
      points(inputs.size()),
      root(geometry::root_cube(bounds)),
      parts(std::move(plan)),
      finder(parts, root) {
  const bool exact = std::all_of(inputs.schemas().begin(), inputs.schemas().end(),
                                 [](const scan::ScanSchema& input) { return input.surface_step.has_value(); });
  scene = {bounds, inputs.schema().z_up, inputs.schema().normals && !exact};
  add_inputs(inputs);
}

BuildFrame::BuildFrame(const BuildInputs& added, std::span<const InputName> lattices, const geometry::RootCube& whole,
                       const geometry::Box& all, bool sides, std::vector<Part> plan)
    : bounds(all), root(whole), parts(std::move(plan)), finder(parts, root), oriented(sides) {
  scene = {bounds, added.schema().z_up, true};
  for (const Part& part : parts) points += part.count;
  for (const InputName& lattice : lattices) names.push_back(lattice);
  sensors.resize(names.size());
  surface_steps.resize(names.size());
  exact_radii.resize(names.size());
  add_inputs(added);
}

void BuildFrame::add_inputs(const BuildInputs& inputs) {
  for (const scan::ScanSchema& input : inputs.schemas()) {
    sensors.push_back(input.sensor);
    surface_steps.push_back(input.surface_step);
    exact_radii.push_back(input.exact_radii);
    two_sided = two_sided || input.two_sided;
    names.push_back({input.name, input.grid});
  }
}

MadePart make_part(const BuildFrame& frame, PartPoints points, size_t part, estimation::RadiusPolicy radii,
                   bool want_order) {
  MadePart made;
  SpatialOrder order = spatial_order(points, frame.root);
  reorder(points.cloud, order.points);
  made.kept = order.distinct ? std::vector<uint8_t>(points.cloud.size(), 1) : drop_duplicates(points, made.report);
  made.own = points.own;
  if (want_order) made.order = std::move(order.points);
  order = {};
  made.inputs = points.inputs;
  const estimation::PartFrame own = frame_of(frame, std::move(points.inputs), part, radii);
  made.surfels = estimation::make_surfels(std::move(points.cloud), own, made.signs, made.report);
  return made;
}

void SceneEvidence::add(estimation::PartSigns signs, std::span<const estimation::RadiusComparison> radii,
                        std::span<const estimation::SurfaceSample> samples) {
  signs_.push_back(std::move(signs));
  samples_.insert(samples_.end(), samples.begin(), samples.end());
  for (size_t input = 0; input < radii.size(); ++input) comparisons_[input].add(radii[input]);
}

SceneDecisions SceneEvidence::decide(const BuildFrame& frame, estimation::RadiusPolicy radii,
                                     estimation::SurfelReport& report) const {
  SceneDecisions decisions;
  decisions.signs = estimation::resolve_signs(signs_, frame.scene);
  decisions.signs.oriented = decisions.signs.oriented && !frame.two_sided;
  if (frame.oriented) {
    decisions.signs.oriented = *frame.oriented;
    decisions.signs.face_up = !*frame.oriented && frame.scene.z_up;
  }
  report.oriented = decisions.signs.oriented;
  for (size_t input = 0; input < comparisons_.size(); ++input) {
    decisions.radii.push_back(estimation::decide_radii(comparisons_[input], policy_of(frame, input, radii)));
    report.radii_estimated += decisions.radii.back().estimated();
    report.scatter += decisions.radii.back().scatter();
  }
  return decisions;
}

void settle_surfels(const SceneDecisions& decisions, const estimation::SurfaceSpacing& spacing, size_t part,
                    std::span<const size_t> inputs, estimation::PartSurfels& surfels) {
  estimation::apply_signs(decisions.signs, part, surfels);
  estimation::apply_radii(decisions.radii, inputs, surfels.estimates, spacing, surfels.cloud);
}

}  // namespace surfcast::builder
