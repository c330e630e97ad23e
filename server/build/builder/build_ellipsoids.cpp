#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "builder/build_kinds.h"
#include "builder/ellipsoid_survey.h"
#include "builder/kind_trees.h"
#include "builder/sorted_ellipsoids.h"
#include "ellipsoid/ellipsoid_input.h"

namespace surfcast::builder {
namespace {

/// An input and what is known of it.
struct Opened {
  std::filesystem::path path;
  ellipsoid::InputPtr input;
  model::EllipsoidSource source;
  geometry::Box bounds;
};

Result<std::vector<Opened>> open_all(std::span<const std::filesystem::path> paths, const BuildOptions& options,
                                     uint64_t memory) {
  std::vector<Opened> inputs;
  uint64_t held = 0;
  for (const std::filesystem::path& path : paths) {
    const bool asked = options.kind == InputKind::kEllipsoids;
    Result<ellipsoid::InputPtr> input = ellipsoid::open_ellipsoids(
        path, {options.tensor_order, options.sample, asked, {memory - std::min(memory, held)}});
    if (!input) return fail(input);
    held += (*input)->held_bytes();
    model::EllipsoidSource source = (*input)->facts();
    inputs.push_back({path, std::move(*input), std::move(source), {}});
  }
  return inputs;
}

/// The words of what is not drawn.
std::string describe(const model::EllipsoidCounts& counts) {
  std::string text = std::to_string(counts.samples - counts.drawn) + " of " + std::to_string(counts.samples) +
                     " glyphs cannot be drawn:";
  const auto add = [&text](uint64_t count, const char* what) {
    if (count > 0) text += (text.ends_with(':') ? " " : ", ") + std::to_string(count) + what;
  };
  add(counts.masked, " with a confidence below 0.5");
  add(counts.not_finite, " with a number that is not finite");
  add(counts.not_positive, " without positive eigenvalues or semi-axes");
  return text;
}

/// Calls `use` for all ellipsoids of an input, run by run, and counts what is not drawn.
template <typename Use>
Status for_each_run(Opened& opened, model::EllipsoidCounts& counts, StageClock& clock, const Use& use) {
  if (Status status = opened.input->rewind(); !status) return status;
  while (!opened.input->at_end()) {
    const uint64_t before = counts.samples;
    const Result<ellipsoid::Ellipsoids> run = opened.input->read(counts);
    if (!run) return fail(run);
    if (Status status = use(*run); !status) return status;
    clock.step(counts.samples - before);
  }
  return {};
}

/// Finds counts, bounds and scale.
Status survey(Opened& opened, StageClock& clock, BuildReport& report) {
  EllipsoidSurvey survey;
  model::EllipsoidCounts& counts = opened.source.counts;
  Status status = for_each_run(opened, counts, clock, [&](const ellipsoid::Ellipsoids& run) -> Status {
    survey.add(run);
    return {};
  });
  if (!status) return status;
  if (counts.drawn == 0) return fail(ErrorKind::kInvalidInput, opened.path.string() + ": " + describe(counts));
  opened.bounds = survey.bounds();
  survey.complete(opened.source);
  report.ellipsoids.push_back({opened.source.name, counts});
  report.scan.points_read += counts.samples;
  if (counts.drawn < counts.samples) report.scan.notes.push_back(opened.source.name + ": " + describe(counts));
  return {};
}

model::ModelSchema schema_of(const std::vector<Opened>& inputs, const BuildOptions& options) {
  model::ModelSchema schema;
  schema.z_up = options.z_up.value_or(inputs.front().input->z_up());
  for (const Opened& opened : inputs) {
    if (opened.input->has_colors()) schema.color_bits = 8;
    schema.source_names.push_back(opened.path.filename().string());
  }
  return schema;
}

Status write(Opened& opened, uint32_t number, const std::filesystem::path& target, model::ModelWriter& writer,
             StageClock& clock, const BuildReport& report) {
  const geometry::RootCube root = geometry::root_cube(opened.bounds);
  const uint64_t drawn = opened.source.counts.drawn;
  clock.begin("sorting", static_cast<size_t>(opened.source.counts.samples));
  EllipsoidSorter sorter(target, root, opened.source, opened.input->has_colors(), report.memory_budget / kSortingShare);
  model::EllipsoidCounts again;
  Status status = for_each_run(opened, again, clock, [&](const ellipsoid::Ellipsoids& run) { return sorter.add(run); });
  if (status) status = sorter.finish();
  if (!status) return status;
  clock.begin("writing blocks", static_cast<size_t>(drawn));
  return write_ellipsoid_tree(sorter, root, opened.source, number, writer,
                              [&clock](uint64_t count) { clock.step(count); });
}

}  // namespace

Status build_ellipsoids(std::span<const std::filesystem::path> inputs, ModelOutput& output, const BuildOptions& options,
                        StageClock& clock, BuildReport& report) {
  Result<std::vector<Opened>> opened = open_all(inputs, options, report.memory_budget);
  if (!opened) return fail(opened);
  uint64_t samples = 0;
  for (const Opened& one : *opened) {
    samples += one.input->samples();
    report.points_in_scans += one.input->samples_of_file();
  }
  clock.know_points(samples);
  clock.begin("reading", static_cast<size_t>(samples));
  for (Opened& one : *opened) {
    if (Status status = survey(one, clock, report); !status) return status;
  }
  const Result<model::ModelWriter*> writer = output.writer(schema_of(*opened, options));
  if (!writer) return fail(writer);
  std::vector<model::EllipsoidSource> sources;
  for (Opened& one : *opened) {
    const auto number = static_cast<uint32_t>(sources.size());
    if (Status status = write(one, number, output.target(), **writer, clock, report); !status) return status;
    sources.push_back(one.source);
    ++report.parts;
  }
  (*writer)->set_ellipsoid_sources(std::move(sources));
  return {};
}

}  // namespace surfcast::builder
