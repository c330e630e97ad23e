#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "builder/build_kinds.h"
#include "builder/field_input.h"
#include "builder/grid_input.h"
#include "builder/volume_pass.h"
#include "model/model_writer.h"

namespace surfcast::builder {
namespace {

/// Memory beside the planes: the program, decoders of inputs and bricks in flight.
constexpr double kVolumeReserve = 64.0 * 1024 * 1024;

Status check_memory(const std::vector<GridInput>& inputs, const std::filesystem::path& target, uint64_t budget) {
  constexpr double kMebibyte = 1024.0 * 1024;
  double most = 0;
  for (const GridInput& input : inputs) most = std::max(most, volume_bytes(input));
  if (kVolumeReserve + most <= static_cast<double>(budget)) return {};
  const auto mebibytes = [](double bytes) { return std::to_string(std::llround(std::ceil(bytes / kMebibyte))) + "M"; };
  return fail(ErrorKind::kLimit, target.string() + ": a memory budget of " + mebibytes(static_cast<double>(budget)) +
                                     " is too small for these grids: it takes at least " +
                                     mebibytes(kVolumeReserve + most));
}

Result<std::vector<GridInput>> open_all(std::span<const std::filesystem::path> paths, std::optional<uint64_t> sample) {
  std::vector<GridInput> inputs;
  for (const std::filesystem::path& path : paths) {
    Result<GridInput> input = GridInput::open(path, sample);
    if (!input) return fail(input);
    inputs.push_back(std::move(*input));
  }
  return inputs;
}

uint64_t planes_of(const std::vector<GridInput>& inputs) {
  uint64_t planes = 0;
  for (const GridInput& input : inputs) planes += input.volume().size.z;
  return planes;
}

Status measure_all(std::vector<GridInput>& inputs, StageClock& clock, BuildReport& report) {
  clock.begin("measuring samples", planes_of(inputs));
  for (GridInput& input : inputs) {
    if (Status status = input.measure([&clock] { clock.step(); }); !status) return status;
    if (input.not_finite() == 0) continue;
    report.scan.notes.push_back(input.volume().name + ": " + std::to_string(input.not_finite()) +
                                " samples are not finite and count as the lowest value");
  }
  return {};
}

model::ModelSchema schema_of(const std::vector<GridInput>& inputs, const BuildOptions& options) {
  model::ModelSchema schema;
  schema.z_up = options.z_up.value_or(true);  // of medical frames z is superior
  for (const GridInput& input : inputs) schema.source_names.push_back(input.path().filename().string());
  return schema;
}

/// The points of one field after the other are in memory while it is sampled.
Status add_fields(std::span<const std::filesystem::path> paths, const std::filesystem::path& target,
                  const BuildOptions& options, StageClock& clock, BuildReport& report, std::vector<GridInput>& inputs) {
  if (paths.empty()) return {};
  clock.begin("sampling fields", paths.size());
  for (const std::filesystem::path& path : paths) {
    Result<GridInput> input =
        open_field(path, *options.field, target, report.memory_budget, options.sample, report.fields);
    if (!input) return fail(input);
    inputs.push_back(std::move(*input));
    clock.step();
  }
  return {};
}

}  // namespace

Status build_volumes(std::span<const std::filesystem::path> grids, std::span<const std::filesystem::path> fields,
                     ModelOutput& output, const BuildOptions& options, StageClock& clock, BuildReport& report) {
  Result<std::vector<GridInput>> inputs = open_all(grids, options.sample);
  if (!inputs) return fail(inputs);
  if (Status status = add_fields(fields, output.target(), options, clock, report, *inputs); !status) return status;
  if (Status status = check_memory(*inputs, output.target(), report.memory_budget); !status) return status;
  for (const GridInput& input : *inputs) {
    report.samples += input.volume().samples();
    report.points_in_scans += input.samples_of_file();
  }
  clock.know_points(report.samples);
  if (Status status = measure_all(*inputs, clock, report); !status) return status;
  const Result<model::ModelWriter*> writer = output.writer(schema_of(*inputs, options));
  if (!writer) return fail(writer);
  clock.begin("writing bricks", planes_of(*inputs));
  std::vector<model::Volume> volumes;
  for (GridInput& input : *inputs) {
    const auto number = static_cast<uint32_t>(volumes.size());
    if (Status status = write_volume(input, number, **writer, clock); !status) return status;
    volumes.push_back(input.volume());
  }
  (*writer)->set_volumes(std::move(volumes));
  report.parts += inputs->size();
  return {};
}

}  // namespace surfcast::builder
