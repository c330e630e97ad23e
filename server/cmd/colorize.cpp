#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "base/log.h"
#include "base/mapped_file.h"
#include "base/scratch_folder.h"
#include "builder/build_model.h"
#include "builder/memory_budget.h"
#include "cmd/commands.h"
#include "cmd/input_flags.h"
#include "colorize/geo_photo.h"
#include "colorize/paint_from_above.h"
#include "colorize/paint_from_cameras.h"
#include "grid/open_scan.h"
#include "model/model_file.h"

namespace surfcast::cmd {
namespace {

struct ColorizeCommand {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path photo;
  std::filesystem::path cameras;
  std::filesystem::path output;
  std::string memory;
  estimation::RadiusPolicy radii = estimation::RadiusPolicy::kAuto;
};

/// Opens a scan with the colours of pictures.
using PaintScan = std::function<Result<scan::ScanStream>(scan::ScanStream scan, const std::filesystem::path& path,
                                                         std::optional<uint64_t> sample)>;

Result<builder::BuildReport> build(const ColorizeCommand& command, const std::filesystem::path& target,
                                   const PaintScan& paint) {
  builder::BuildOptions options;
  options.memory = builder::parse_memory_size(command.memory);
  options.radii = command.radii;
  options.meshes.faces = mesh::FacePolicy::kIgnore;
  options.open = [&paint](const std::filesystem::path& input, const scan::DecodingLimit& limit,
                          std::optional<uint64_t> sample) -> Result<scan::ScanStream> {
    Result<scan::ScanStream> scan = grid::open_scan(input, limit);
    if (!scan || !paint) return scan;
    return paint(std::move(*scan), input, sample);
  };
  return builder::build_model(command.inputs, target, options, [](const builder::BuildStep&) {});
}

Status build_painted(const ColorizeCommand& command, const PaintScan& paint, const colorize::PaintReport& painted) {
  const Result<builder::BuildReport> report = build(command, command.output, paint);
  if (!report) return fail(report);
  for (const std::string& note : report->scan.notes) spdlog::warn("{}", note);
  std::cout << fmt::format(
      "{} points have the pictures' colours, {} are hidden from them, {} outside\n{} surfels, {} bytes\n",
      painted.painted, painted.hidden, painted.outside, report->surfels, report->bytes);
  return {};
}

Status colorize_from_above(const ColorizeCommand& command, const scan::DecodingLimit& limit) {
  const Result<colorize::GeoPhoto> photo = colorize::read_geo_photo(command.photo, limit);
  if (!photo) return fail(photo);
  colorize::PaintReport painted;
  const PaintScan paint = [&](scan::ScanStream scan, const std::filesystem::path& input,
                              std::optional<uint64_t> sample) {
    return colorize::paint_from_above(std::move(scan), input, *photo, limit, sample, painted);
  };
  return build_painted(command, paint, painted);
}

/// A surface as far behind the visible one as two radii of surfels is the same surface.
double tolerance_of(const model::ModelFile& model) {
  double widest = 0;
  for (const ldc::BlockEntry& block : model.blocks()) {
    if (block.level == 0) widest = std::max(widest, double{block.spacing});
  }
  return 2 * widest;
}

/// Builds the model twice: to see what hides what, and with the colours.
Status colorize_from_cameras(const ColorizeCommand& command, const scan::DecodingLimit& limit) {
  const Result<MappedFile> file = MappedFile::open(command.cameras);
  if (!file) return fail(file);
  const auto* text = reinterpret_cast<const char*>(file->bytes().data());
  const auto cameras = colorize::parse_cameras({text, file->bytes().size()}, command.cameras);
  if (!cameras) return fail(cameras);
  const std::filesystem::path folder = command.output.parent_path();
  const Result<ScratchFolder> scratch = ScratchFolder::create(folder.empty() ? "." : folder, ".colorize-");
  if (!scratch) return fail(scratch);
  const std::filesystem::path plain = scratch->path() / "plain.surf";
  if (const Result<builder::BuildReport> built = build(command, plain, {}); !built) return fail(built);
  const Result<model::ModelFile> model = model::ModelFile::open(plain);
  if (!model) return fail(model);
  const Result<std::vector<colorize::Photo>> photos = colorize::take_photos(*cameras, *model, limit);
  if (!photos) return fail(photos);
  colorize::PaintReport painted;
  const PaintScan paint = [&](scan::ScanStream scan, const std::filesystem::path& input,
                              std::optional<uint64_t> sample) {
    const colorize::Painter painter = colorize::painter_of(*photos, tolerance_of(*model));
    return colorize::paint_scan(std::move(scan), input, painter, sample, painted);
  };
  return build_painted(command, paint, painted);
}

Status colorize(const ColorizeCommand& command) {
  const Result<uint64_t> budget = builder::memory_budget(builder::parse_memory_size(command.memory));
  if (!budget) return fail(budget);
  const scan::DecodingLimit limit{*budget / 4};
  return command.cameras.empty() ? colorize_from_above(command, limit) : colorize_from_cameras(command, limit);
}

}  // namespace

void add_colorize_command(CLI::App& app, Status& outcome) {
  auto command = std::make_shared<ColorizeCommand>();
  CLI::App* colorize_command = app.add_subcommand("colorize", "Build a model of scans with the colours of a picture");
  colorize_command->add_option("SCAN", command->inputs, "Scans, in the coordinates of the picture")->required();
  CLI::Option* photo = colorize_command->add_option(
      "--orthophoto", command->photo, "Picture from above, with a world file beside it or the tags of GeoTIFF");
  colorize_command
      ->add_option("--cameras", command->cameras,
                   "Pictures and the cameras that took them, as JSON (either of the two)")
      ->excludes(photo);
  colorize_command->add_option("--output", command->output, "Model file to write")->required();
  colorize_command
      ->add_option("--memory", command->memory,
                   "Memory limit, like 4G or 512M (default: a quarter of the machine's memory)")
      ->check([](const std::string& text) {
        return builder::parse_memory_size(text) ? std::string() : "not a size like 4G or 512M: " + text;
      });
  add_radius_flag(*colorize_command, command->radii);
  colorize_command->callback([command, &outcome] {
    if (command->photo.empty() && command->cameras.empty()) throw CLI::RequiredError("--orthophoto or --cameras");
    outcome = colorize(*command);
  });
}

}  // namespace surfcast::cmd
