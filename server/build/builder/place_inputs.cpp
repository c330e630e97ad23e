#include "builder/place_inputs.h"

#include <utility>

namespace surfcast::builder {
namespace {

using MaybeSystem = std::optional<crs::CoordinateSystem>;

/// A system that an option names; none if it is empty.
Result<MaybeSystem> system_of_option(const char* option, const std::string& text) {
  if (text.empty()) return MaybeSystem();
  return crs::read_system(text)
      .map([](crs::CoordinateSystem system) { return MaybeSystem(std::move(system)); })
      .map_error([&](const Error& error) {
        return Error{error.kind, std::string(option) + ": " + error.message};
      });
}

/// What a file states, if it makes sense.
MaybeSystem stated_system(const scan::ScanSchema& input, const geometry::Box& bounds, std::vector<std::string>& notes) {
  if (input.crs.empty()) return {};
  Result<crs::CoordinateSystem> system = crs::read_system(input.crs);
  if (!system) {
    notes.push_back(input.name + ": its coordinate system is ignored, " + system.error().message);
    return {};
  }
  if (!system->is_metric() && crs::degrees_of(*system, bounds).empty()) {
    notes.push_back(input.name + ": its coordinate system is ignored, the points are not where " + system->name +
                    " has coordinates");
    return {};
  }
  return std::move(*system);
}

std::vector<MaybeSystem> systems_of(std::span<const scan::ScanSchema> inputs, std::span<const geometry::Box> bounds,
                                    const MaybeSystem& assigned, bool overrides_stated,
                                    std::vector<std::string>& notes) {
  std::vector<MaybeSystem> systems;
  for (size_t i = 0; i < inputs.size(); ++i) {
    MaybeSystem system;
    if (!assigned || !overrides_stated) system = stated_system(inputs[i], bounds[i], notes);
    if (!system) system = assigned;
    if (system && !crs::is_in_area_of_use(*system, bounds[i])) {
      notes.push_back(inputs[i].name + ": lies outside the area that " + system->name + " is made for");
    }
    systems.push_back(std::move(system));
  }
  return systems;
}

model::CoordinateSystem stored(const crs::CoordinateSystem& system) {
  return {system.name, system.id, system.wkt};
}

/// Finds the way of each input into the system of the model.
Status find_moves(std::span<const scan::ScanSchema> inputs, std::span<const geometry::Box> bounds,
                  std::span<const MaybeSystem> systems, const crs::CoordinateSystem& metric, Placement& placement) {
  for (size_t i = 0; i < inputs.size(); ++i) {
    if (bounds[i].empty() || crs::are_same(*systems[i], metric)) continue;
    Result<crs::Transformation> move = crs::Transformation::between(*systems[i], metric, bounds[i]);
    if (!move) return fail_about(inputs[i].name, move);
    placement.transformed.push_back({inputs[i].name, systems[i]->name, metric.name, move->name(), move->accuracy()});
    placement.moves[i] = std::make_shared<const crs::Transformation>(std::move(*move));
  }
  return {};
}

}  // namespace

Result<Placement> place_inputs(std::span<const scan::ScanSchema> inputs, std::span<const geometry::Box> bounds,
                               const SystemOptions& options) {
  Placement placement;
  placement.moves.resize(inputs.size());
  const Result<MaybeSystem> assigned = system_of_option("--crs", options.assigned);
  if (!assigned) return fail(assigned);
  Result<MaybeSystem> target = system_of_option("--to-crs", options.target);
  if (!target) return fail(target);
  std::vector<MaybeSystem> systems = systems_of(inputs, bounds, *assigned, options.overrides_stated, placement.notes);
  size_t first = 0;
  while (first < systems.size() && !systems[first]) ++first;
  if (first == systems.size()) {
    if (!*target) return placement;
    return fail(ErrorKind::kInvalidInput, "--to-crs: no input has a coordinate system that is known; --crs states it");
  }
  const crs::CoordinateSystem source = *target ? **target : *systems[first];
  const Result<crs::CoordinateSystem> metric =
      crs::metric_system(source, crs::degrees_of(*systems[first], bounds[first]));
  if (!metric) return fail_about(inputs[first].name, metric);
  for (size_t i = 0; i < systems.size(); ++i) {
    if (systems[i]) continue;
    systems[i] = source;
    placement.notes.push_back(inputs[i].name + ": states no coordinate system, taken for " + source.name);
  }
  if (Status status = find_moves(inputs, bounds, systems, *metric, placement); !status) return fail(status);
  placement.georeference.system = stored(*metric);
  if (!crs::are_same(source, *metric)) placement.georeference.source = stored(source);
  return placement;
}

}  // namespace surfcast::builder
