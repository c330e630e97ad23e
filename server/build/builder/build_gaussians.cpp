#include <algorithm>
#include <filesystem>
#include <utility>

#include "builder/build_kinds.h"
#include "builder/gaussian_sample.h"
#include "builder/kind_trees.h"
#include "gaussian/gaussian_format.h"
#include "gaussian/gaussian_reader.h"

namespace surfcast::builder {
namespace {

constexpr uint64_t kRun = 8192;  // Gaussians that are read at once

std::string name_of(const std::filesystem::path& path) {
  const std::filesystem::path name = path.filename();
  return name.empty() ? path.parent_path().filename().string() : name.string();
}

using Readers = std::vector<gaussian::GaussianReader>;

Result<Readers> open_readers(std::span<const std::filesystem::path> inputs, uint64_t memory) {
  Readers readers;
  uint64_t held = 0;
  for (const std::filesystem::path& input : inputs) {
    Result<gaussian::GaussianReader> reader = gaussian::GaussianReader::open(input, {memory - std::min(memory, held)});
    if (!reader) return fail(reader);
    held += reader->held_bytes();
    readers.push_back(std::move(*reader));
  }
  return readers;
}

/// Fails if a model cannot hold both.
Status check_alike(const Readers& readers, std::span<const std::filesystem::path> inputs) {
  const gaussian::GaussianTraits& first = readers.front().traits();
  for (size_t i = 1; i < readers.size(); ++i) {
    const gaussian::GaussianTraits& other = readers[i].traits();
    if (other.antialiased == first.antialiased && other.flat == first.flat && other.up == first.up) continue;
    return fail(ErrorKind::kUnsupported,
                inputs[i].string() + ": is trained otherwise than " + inputs[0].string() + ": build a model of each");
  }
  return {};
}

/// Adds coefficients of 0 for the degrees that Gaussians do not have.
void raise_degree(gaussian::Gaussians& gaussians, int from, int to) {
  if (from == to) return;
  const size_t before = 3 * gaussian::harmonics_of(from);
  const size_t after = 3 * gaussian::harmonics_of(to);
  std::vector<float> harmonics(gaussians.size() * after);
  for (size_t i = 0; i < gaussians.size(); ++i) {
    std::copy_n(gaussians.harmonics.begin() + static_cast<ptrdiff_t>(i * before), before,
                harmonics.begin() + static_cast<ptrdiff_t>(i * after));
  }
  gaussians.harmonics = std::move(harmonics);
}

/// Calls `use` for all Gaussians, run by run, or for a sample of so many of each input.
template <typename Use>
Status for_each_run(Readers& readers, int degree, std::optional<uint64_t> sampled, const Use& use) {
  for (gaussian::GaussianReader& reader : readers) {
    GaussianSample sample(reader.traits().count, sampled);
    reader.rewind();
    while (reader.position() < reader.traits().count) {
      Result<gaussian::Gaussians> run = reader.read(kRun);
      if (!run) return fail(run);
      raise_degree(*run, reader.traits().degree, degree);
      sample.thin(*run);
      if (Status status = use(*run); !status) return status;
    }
  }
  return {};
}

int degree_of(const Readers& readers) {
  int degree = 0;
  for (const gaussian::GaussianReader& reader : readers) degree = std::max(degree, reader.traits().degree);
  return degree;
}

/// Counts what is usable and finds its bounds.
Result<geometry::Box> survey(Readers& readers, std::optional<uint64_t> sampled, StageClock& clock,
                             BuildReport& report) {
  geometry::Box box;
  Status status = for_each_run(readers, degree_of(readers), sampled, [&](const gaussian::Gaussians& run) -> Status {
    for (const glm::dvec3& position : run.positions) box.include(position);
    report.gaussians += run.size();
    report.scan.points_read += run.size() + run.unusable;
    report.scan.not_finite += run.unusable;
    clock.step();
    return {};
  });
  if (!status) return fail(status);
  return box;
}

model::ModelSchema schema_of(const Readers& readers, std::span<const std::filesystem::path> inputs,
                             const BuildOptions& options) {
  model::ModelSchema schema;
  schema.z_up = options.z_up.value_or(false);
  schema.upside_down = !options.z_up && readers.front().traits().up == gaussian::UpAxis::kMinusY;
  schema.color_bits = 8;
  schema.harmonics_degree = degree_of(readers);
  for (const std::filesystem::path& input : inputs) schema.source_names.push_back(name_of(input));
  return schema;
}

size_t run_count(const Readers& readers) {
  uint64_t runs = 0;
  for (const gaussian::GaussianReader& reader : readers) runs += (reader.traits().count + kRun - 1) / kRun;
  return static_cast<size_t>(std::max<uint64_t>(runs, 1));
}

}  // namespace

bool holds_gaussians(const std::filesystem::path& input) {
  std::error_code ignored;  // if a file does not exist, reading it reports the error
  const bool folder = std::filesystem::is_directory(input, ignored);
  const std::filesystem::path content = folder ? input / "meta.json" : input;
  const Result<stream::FilePtr> file = stream::open_shared(content);
  return file && gaussian::gaussian_format_of(*file, content).has_value();
}

Status build_gaussians(std::span<const std::filesystem::path> inputs, ModelOutput& output, const BuildOptions& options,
                       StageClock& clock, BuildReport& report) {
  Result<Readers> readers = open_readers(inputs, report.memory_budget);
  if (!readers) return fail(readers);
  if (Status status = check_alike(*readers, inputs); !status) return status;
  clock.begin("reading", run_count(*readers));
  for (const gaussian::GaussianReader& reader : *readers) report.points_in_scans += reader.traits().count;
  const Result<geometry::Box> box = survey(*readers, options.sample, clock, report);
  if (!box) return fail(box);
  if (report.gaussians == 0) {
    return fail(ErrorKind::kInvalidInput, output.target().string() + ": no usable Gaussian is left of the input");
  }
  clock.know_points(report.gaussians);
  clock.begin("sorting", run_count(*readers));
  const geometry::RootCube root = geometry::root_cube(*box);
  const gaussian::GaussianTraits& traits = readers->front().traits();
  const int degree = degree_of(*readers);
  GaussianSorter sorter(output.target(), root, degree, report.memory_budget / kSortingShare);
  Status status = for_each_run(*readers, degree, options.sample, [&](const gaussian::Gaussians& run) {
    clock.step();
    return sorter.add(run);
  });
  if (status) status = sorter.finish();
  if (!status) return status;
  const Result<model::ModelWriter*> writer = output.writer(schema_of(*readers, inputs, options));
  if (!writer) return fail(writer);
  clock.begin("writing blocks", static_cast<size_t>(report.gaussians));
  ++report.parts;
  return write_gaussian_tree(sorter, root, {degree, traits.antialiased, traits.flat}, **writer,
                             [&clock](uint64_t count) { clock.step(count); });
}

}  // namespace surfcast::builder
