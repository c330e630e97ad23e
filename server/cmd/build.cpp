#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <oneapi/tbb/global_control.h>
#include <spdlog/fmt/fmt.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "base/json_text.h"
#include "base/log.h"
#include "builder/append_model.h"
#include "builder/build_model.h"
#include "builder/grid_input.h"
#include "builder/memory_budget.h"
#include "cmd/build_flags.h"
#include "cmd/build_progress.h"
#include "cmd/commands.h"
#include "cmd/georeference_text.h"
#include "cmd/input_flags.h"
#include "isosurface/surface_inputs.h"

namespace surfcast::cmd {
namespace {

struct BuildCommand {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path output;
  std::filesystem::path into;  ///< a model that the inputs are added to, instead
  ModelFlags model;
  std::optional<size_t> parts;
  estimation::RadiusPolicy radii = estimation::RadiusPolicy::kAuto;
  std::filesystem::path report;
  std::optional<uint64_t> sample;
  scan::Selection selection;
  std::optional<simplify::ErrorBound> simplify;
  RunFlags run;
  bool background = false;
  std::vector<isosurface::IsoSurface> surfaces;  ///< of grids among the inputs
  std::optional<builder::InputKind> kind;
  std::optional<scattered::FieldOptions> field;
  std::optional<grid::TensorOrder> tensor_order;
  builder::MeshOptions meshes;
  builder::SystemOptions systems;
};

/// Leaves the processors to other programs, and ends when the program that started this one does. What has already
/// ended is noticed by a changed parent.
Status go_into_background(bool sample) {
  constexpr int kMinPriority = 19;
  constexpr int kSamplePriority = 5;  // done within seconds, for which somebody waits
  const pid_t parent = ::getppid();
  if (::setpriority(PRIO_PROCESS, 0, sample ? kSamplePriority : kMinPriority) != 0 ||
      ::prctl(PR_SET_PDEATHSIG, SIGTERM) != 0) {
    return fail(ErrorKind::kIo, std::string("cannot go into the background: ") + std::strerror(errno));
  }
  if (::getppid() != parent) return fail(ErrorKind::kCancelled, "the program that started this one has ended");
  return {};
}

std::string figures(const builder::BuildReport& report) {
  const double peak = static_cast<double>(report.peak_memory) / (1024.0 * 1024.0);
  const uint64_t ellipsoids = report.drawn_ellipsoids();
  if ((report.samples > 0) + (report.gaussians > 0) + (report.surfels > 0) + (ellipsoids > 0) > 1) {
    return fmt::format(
        "{} surfels, {} samples, {} Gaussians, {}{} blocks, {} bytes, {:.2f} s, {:.0f} MiB peak memory\n",
        report.surfels, report.samples, report.gaussians,
        ellipsoids > 0 ? fmt::format("{} ellipsoids, ", ellipsoids) : "", report.blocks, report.bytes, report.seconds,
        peak);
  }
  if (ellipsoids > 0) {
    return fmt::format("{} samples read, {} ellipsoids, {} bytes, {:.2f} s, {:.0f} samples/s, {:.0f} MiB peak memory\n",
                       report.scan.points_read, ellipsoids, report.bytes, report.seconds, report.points_per_second(),
                       peak);
  }
  if (report.samples > 0) {
    return fmt::format("{} samples read, {} blocks, {} bytes, {:.2f} s, {:.0f} samples/s, {:.0f} MiB peak memory\n",
                       report.samples, report.blocks, report.bytes, report.seconds, report.samples_per_second(), peak);
  }
  if (report.gaussians > 0) {
    return fmt::format("{} Gaussians, {} bytes, {:.2f} s, {:.0f} Gaussians/s, {:.0f} MiB peak memory\n",
                       report.gaussians, report.bytes, report.seconds, report.points_per_second(), peak);
  }
  return fmt::format("{} points read, {} surfels, {} bytes, {:.2f} s, {:.0f} points/s, {:.0f} MiB peak memory\n",
                     report.scan.points_read, report.surfels, report.bytes, report.seconds, report.points_per_second(),
                     peak);
}

/// What was found of each surface.
std::string surface_lines(const std::vector<isosurface::InputSurfaces>& inputs) {
  std::string lines;
  for (const auto& [input, surfaces] : inputs) {
    for (const isosurface::SurfaceReport& surface : surfaces) {
      lines += fmt::format("{}: {} points of the surface at {}\n", input, surface.points, surface.value);
    }
  }
  return lines;
}

nlohmann::ordered_json to_json(const std::vector<isosurface::InputSurfaces>& inputs) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const auto& [input, surfaces] : inputs) {
    for (const isosurface::SurfaceReport& surface : surfaces) {
      json.push_back({{"input", input},
                      {"value", surface.value},
                      {"points", surface.points},
                      {"thinned", surface.thinned},
                      {"lost", surface.lost}});
    }
  }
  return json;
}

/// What became of the meshes.
std::string mesh_lines(const std::vector<builder::InputMesh>& meshes) {
  std::string lines;
  for (const auto& [input, mesh] : meshes) {
    lines += fmt::format("{}: {} triangles, {} surfels", input, mesh.triangles, mesh.surfels);
    if (mesh.texels > 0) lines += fmt::format(", {:.0f} texels", mesh.texels);
    lines += "\n";
  }
  return lines;
}

nlohmann::ordered_json to_json(const std::vector<builder::InputMesh>& meshes) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const auto& [input, mesh] : meshes) {
    json.push_back({{"input", input},
                    {"triangles", mesh.triangles},
                    {"surfels", mesh.surfels},
                    {"textured_surfels", mesh.textured},
                    {"texels", mesh.texels},
                    {"texels_per_surfel", mesh.textured > 0 ? mesh.texels / static_cast<double>(mesh.textured) : 0.0},
                    {"masked", mesh.masked},
                    {"images", mesh.images},
                    {"images_missing", mesh.images_missing},
                    {"two_sided", mesh.two_sided}});
  }
  return json;
}

/// What became of the samples of fields.
std::string field_lines(const std::vector<builder::InputField>& fields) {
  std::string lines;
  for (const builder::InputField& field : fields) {
    lines += fmt::format("{}: {} samples of a field, {:.6g} from sample to sample of the volume", field.input,
                         field.samples, field.step);
    if (field.skipped > 0) lines += fmt::format(", {} points skipped", field.skipped);
    if (field.widened > 0) lines += fmt::format(", {} kernels widened to that", field.widened);
    lines += "\n";
  }
  return lines;
}

nlohmann::ordered_json to_json(const builder::InputField& field) {
  return {{"input", field.input},
          {"samples", field.samples},
          {"skipped", field.skipped},
          {"widened", field.widened},
          {"step", field.step}};
}

nlohmann::ordered_json to_json(const std::vector<builder::TransformedInput>& inputs) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const builder::TransformedInput& input : inputs) {
    json.push_back({{"input", input.input}, {"from", input.from}, {"to", input.to}, {"operation", input.operation}});
    if (input.accuracy) json.back()["accuracy"] = *input.accuracy;
  }
  return json;
}

/// What a simplified model is, and its errors.
std::string simplify_lines(const BuildCommand& command, const builder::BuildReport& report) {
  if (!command.simplify || !report.simplified || !report.simplified->pays) return {};
  const simplify::SimplifyReport& s = *report.simplified;
  const std::string height = command.simplify->height ? fmt::format("height within {}", *command.simplify->height)
                                                      : fmt::format("height within {} times the angle and the distance",
                                                                    simplify::kHeightPerAngle);
  return fmt::format(
      "{} points simplified to {} surfels, {} with curvature, {} that no surface fits; asked for: nine in "
      "ten normals of a surfel within {} degrees, {}; largest: {:.3g} degrees, height {:.3g}\n",
      s.samples, s.points, s.curved, s.kept, command.simplify->degrees, height, s.degrees, s.height);
}

nlohmann::ordered_json to_json(const simplify::ErrorBound& bound, const simplify::SimplifyReport& s) {
  nlohmann::ordered_json json{{"bound_degrees", bound.degrees},
                              {"points", s.samples},
                              {"surfels", s.points},
                              {"curved", s.curved},
                              {"kept", s.kept},
                              {"degrees", s.degrees},
                              {"height", s.height},
                              {"simplified", s.pays}};
  if (bound.height) json["bound_height"] = *bound.height;
  if (!s.pays) json["reason"] = s.reason;
  return json;
}

/// What became of the radii of each input, beside those that the notes name.
std::string radii_lines(const builder::BuildReport& report) {
  std::string lines;
  for (const auto& [input, decision] : report.radii) {
    const bool of_mesh = std::any_of(report.meshes.begin(), report.meshes.end(),
                                     [&name = input](const builder::InputMesh& mesh) { return mesh.input == name; });
    if (of_mesh || decision.outcome == estimation::RadiusOutcome::kEstimated) continue;
    lines += fmt::format("{}: {}\n", input, estimation::describe(decision));
  }
  return lines;
}

nlohmann::ordered_json to_json(const builder::InputRadii& radii) {
  constexpr std::array kOutcomes{"kept", "scaled", "estimated"};
  const estimation::RadiusDecision& decision = radii.decision;
  nlohmann::ordered_json json{{"input", radii.input},
                              {"outcome", kOutcomes.at(static_cast<size_t>(decision.outcome))},
                              {"stated", decision.stated},
                              {"missing", decision.missing}};
  if (decision.stating) {
    const auto& [median, least, most] = *decision.stating;
    json["spacings"] = {{"median", median}, {"least", least}, {"most", most}};
  }
  if (decision.outcome == estimation::RadiusOutcome::kScaled) json["factor"] = decision.factor;
  return json;
}

nlohmann::ordered_json to_json(const builder::InputEllipsoids& input) {
  const model::EllipsoidCounts& counts = input.counts;
  return {{"input", input.input},    {"samples", counts.samples},       {"drawn", counts.drawn},
          {"masked", counts.masked}, {"not_finite", counts.not_finite}, {"not_positive", counts.not_positive}};
}

std::string to_json(const BuildCommand& command, const builder::BuildReport& report,
                    const std::vector<isosurface::InputSurfaces>& surfaces) {
  nlohmann::ordered_json json{
      {"output", (command.into.empty() ? command.output : command.into).string()},
      {"points_read", report.scan.points_read},
      {"points_in_scans", report.points_in_scans},
      {"samples", report.samples},
      {"surfels", report.surfels},
      {"gaussians", report.gaussians},
      {"blocks", report.blocks},
      {"bytes", report.bytes},
      {"seconds", report.seconds},
      {"points_per_second", report.points_per_second()},
      {"memory_budget_bytes", report.memory_budget},
      {"peak_memory_bytes", report.peak_memory},
      {"parts", report.parts},
      {"stage_seconds", nlohmann::ordered_json::object()},
      {"dropped",
       {{"not_finite", report.scan.not_finite},
        {"duplicates", report.scan.duplicates},
        {"zero_normals", report.scan.zero_normals}}},
      {"estimated", {{"normals", report.scan.normals_estimated}, {"radii", report.scan.radii_estimated}}},
      {"scatter", report.scan.scatter},
      {"radii", nlohmann::ordered_json::array()},
      {"oriented", report.scan.oriented},
      {"notes", report.scan.notes},
      {"inputs", nlohmann::ordered_json::array()},
  };
  for (const auto& [stage, seconds] : report.stages) {
    nlohmann::ordered_json& total = json["stage_seconds"][stage];
    total = seconds + (total.is_number() ? total.get<double>() : 0.0);
  }
  for (const builder::InputRadii& radii : report.radii) json["radii"].push_back(to_json(radii));
  if (!surfaces.empty()) json["surfaces"] = to_json(surfaces);
  for (const builder::InputEllipsoids& input : report.ellipsoids) json["ellipsoids"].push_back(to_json(input));
  for (const builder::InputField& field : report.fields) json["fields"].push_back(to_json(field));
  if (!report.meshes.empty()) json["meshes"] = to_json(report.meshes);
  if (report.georeference.known()) {
    json["coordinate_system"] = json_of(report.georeference);
    json["transformed"] = to_json(report.transformed);
  }
  if (report.appended) {
    json["appended"] = {{"surfels_before", report.appended->surfels_before},
                        {"blocks_copied", report.appended->blocks_copied}};
  }
  if (command.simplify && report.simplified) json["simplify"] = to_json(*command.simplify, *report.simplified);
  for (const std::filesystem::path& input : command.inputs) json["inputs"].push_back(input.string());
  return json_text(json, 2) + "\n";
}

/// An error if surfaces are wanted and no input has any. What does not exist is an error of reading.
Status check_surfaces(const BuildCommand& command) {
  const auto may_have = [](const std::filesystem::path& input) {
    return builder::is_grid(input) || !std::filesystem::exists(input);
  };
  if (command.surfaces.empty() || std::any_of(command.inputs.begin(), command.inputs.end(), may_have)) return {};
  return fail(ErrorKind::kInvalidInput, command.inputs[0].string() + ": --iso needs a volume, and no input is one");
}

Result<builder::BuildReport> make_model(const BuildCommand& command, isosurface::SurfaceInputs& surfaces,
                                        const builder::BuildProgress& progress) {
  builder::BuildOptions options;
  options.precision = command.model.precision;
  options.z_up = command.model.z_up();
  options.memory = builder::parse_memory_size(command.model.memory);
  options.parts = command.parts;
  options.sample = command.sample;
  options.selection = command.selection;
  options.radii = command.radii;
  options.kind = command.kind;
  options.field = command.field;
  options.tensor_order = command.tensor_order;
  options.meshes = command.meshes;
  options.systems = command.systems;
  options.simplify = command.simplify;
  if (!command.surfaces.empty()) options.open = std::bind_front(&isosurface::SurfaceInputs::open, &surfaces);
  return builder::build_model(command.inputs, command.output, options, progress);
}

Result<builder::BuildReport> append_into(const BuildCommand& command, const builder::BuildProgress& progress) {
  builder::AppendOptions options;
  options.precision = command.model.precision;
  options.memory = builder::parse_memory_size(command.model.memory);
  options.radii = command.radii;
  options.selection = command.selection;
  options.systems = command.systems;
  return builder::append_to_model(command.inputs, command.into, options, progress);
}

/// How much of a model was copied to which the inputs were added.
std::string append_lines(const builder::BuildReport& report) {
  if (!report.appended) return {};
  return fmt::format("added to {} surfels, {} of {} blocks are copies\n", report.appended->surfels_before,
                     report.appended->blocks_copied, report.blocks);
}

Status build(BuildCommand& command) {
  if (Status status = open_folders(command.inputs); !status) return status;
  if (Status status = check_surfaces(command); !status) return status;
  keep_freed_memory();
  if (command.background) {
    if (Status status = go_into_background(command.sample.has_value()); !status) return status;
  }
  std::optional<oneapi::tbb::global_control> threads;
  if (command.run.threads > 0)
    threads.emplace(oneapi::tbb::global_control::max_allowed_parallelism, command.run.threads);
  Result<builder::BuildReport> report;
  isosurface::SurfaceInputs surfaces(command.surfaces, command.output);
  {
    BuildProgressReport progress(command.run.style(), command.run.points_per_second());
    const auto note = [&progress](const builder::BuildStep& step) { progress.note(step); };
    report = command.into.empty() ? make_model(command, surfaces, note) : append_into(command, note);
  }
  if (!report) return fail(report);
  for (const std::string& note : report->scan.notes) spdlog::warn("{}", note);
  std::cout << surface_lines(surfaces.found()) << mesh_lines(report->meshes) << field_lines(report->fields)
            << system_lines(report->transformed, report->georeference) << radii_lines(*report)
            << simplify_lines(command, *report) << append_lines(*report) << figures(*report);
  if (command.report.empty()) return {};
  return write_file_atomically(command.report, to_json(command, *report, surfaces.found()));
}

void add_kind_flags(CLI::App& app, BuildCommand& command) {
  static const std::map<std::string, builder::InputKind> kKinds{{"surfel", builder::InputKind::kScan},
                                                                {"grid", builder::InputKind::kGrid},
                                                                {"gaussian", builder::InputKind::kGaussians},
                                                                {"ellipsoid", builder::InputKind::kEllipsoids}};
  static const std::map<std::string, grid::TensorOrder> kOrders{
      {"lower", grid::TensorOrder::kLower}, {"fsl", grid::TensorOrder::kFsl}, {"mrtrix", grid::TensorOrder::kMrtrix}};
  app.add_option_function<std::string>(
         "--kind", [&command](const std::string& kind) { command.kind = kKinds.at(kind); },
         "What all inputs become: surfel, grid, gaussian or ellipsoid (default: as their content says)")
      ->check(CLI::IsMember({"surfel", "grid", "gaussian", "ellipsoid"}));
  app.add_option_function<std::string>(
         "--tensor-order", [&command](const std::string& order) { command.tensor_order = kOrders.at(order); },
         "Six components of a NIfTI file that does not state what they are: lower (xx xy yy xz yz zz), fsl (xx xy xz "
         "yy "
         "yz zz) or mrtrix (xx yy zz xy xz yz)")
      ->check(CLI::IsMember({"lower", "fsl", "mrtrix"}));
}

}  // namespace

void add_build_command(CLI::App& app, Status& outcome) {
  auto command = std::make_shared<BuildCommand>();
  CLI::App* build_command = app.add_subcommand("build", "Build a model file from scans or volumes");
  build_command
      ->add_option("INPUT", command->inputs,
                   "Scans, regular grids, Gaussians, tensor fields or tables of ellipsoids, or folders of them")
      ->required();
  build_command->add_option("--output", command->output, "Model file to write");
  CLI::Option* into = build_command->add_option("--into", command->into,
                                                "Model file that the scans are added to, instead of --output. Only the "
                                                "blocks near them are made anew");
  add_model_flags(*build_command, command->model);
  build_command
      ->add_option("--parts", command->parts,
                   "Parts that scans are worked on in (default: as the memory allows). The model is that of build-plan "
                   "with the same number")
      ->check(CLI::PositiveNumber);
  add_kind_flags(*build_command, *command);
  add_field_flags(*build_command, command->field);
  add_radius_flag(*build_command, command->radii);
  add_selection_flags(*build_command, command->selection);
  add_iso_flag(*build_command, command->surfaces);
  add_mesh_flags(*build_command, command->meshes);
  add_simplify_flag(*build_command, command->simplify);
  build_command->get_option("--parts")->excludes("--simplify");
  add_system_flags(*build_command, command->systems);
  build_command->add_option("--report", command->report, "Write statistics of the build to this file as JSON");
  build_command
      ->add_option("--sample", command->sample,
                   "Build a preview: of about that many points of each scan, spread over it, with radii for their "
                   "spacing, or of as many samples of each volume")
      ->check(CLI::PositiveNumber);
  add_run_flags(*build_command, command->run);
  build_command->add_flag("--background", command->background,
                          "Leave the processors to other programs, and end when the program that started this ends");
  for (const char* other : {"--output", "--up", "--parts", "--kind", "--tensor-order", "--value", "--iso", "--simplify",
                            "--sample", "--to-crs"}) {
    into->excludes(build_command->get_option(other));
  }
  build_command->callback([command, &outcome] {
    if (command->output.empty() && command->into.empty()) throw CLI::RequiredError("--output or --into");
    outcome = build(*command);
  });
}

}  // namespace surfcast::cmd
