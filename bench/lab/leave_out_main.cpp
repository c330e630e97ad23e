// leave_out: builds models from four fifths of the points of scans and looks for the others; see --help.

#include <CLI/CLI.hpp>
#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <unistd.h>

#include "base/file_source.h"
#include "bench_support.h"
#include "builder/build_model.h"
#include "exporter/export_scan.h"
#include "lab/colored_points.h"
#include "lab/kernel_defines.h"
#include "lab/leave_out_report.h"
#include "lab/renderer_thread.h"
#include "lab/report.h"
#include "point_tree/open_in_place.h"
#include "shared/kernel.h"

namespace surfcast::lab {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> scans;  ///< PLACE:PATH
  std::vector<double> sigmas{SURFCAST_KERNEL_SIGMA};
  fs::path builder;
  bool in_place = false;
  fs::path model;
  fs::path keep;
  fs::path pictures;
  fs::path report;
  fs::path docs;
  fs::path before;
};

[[noreturn]] void stop(const std::string& message) {
  std::fprintf(stderr, "leave_out: %s\n", message.c_str());
  std::exit(1);
}

std::string content_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

void write(const fs::path& path, const std::string& content) {
  if (!(std::ofstream(path) << content)) stop(path.string() + " cannot be written");
}

/// Quotes a word for the shell.
std::string shell_word(const fs::path& path) {
  std::string text = "'";
  for (const char c : path.string()) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// Builds a model with the builder of this tree, or with another program of the same command line.
void build(const fs::path& scan, const fs::path& target, bool z_up, const fs::path& builder) {
  if (builder.empty()) {
    builder::BuildOptions options;
    options.z_up = z_up;
    bench::value_or_exit(builder::build_model(std::array{scan}, target, options, [](const builder::BuildStep&) {}));
    return;
  }
  const std::string command = shell_word(builder) + " build " + shell_word(scan) + " --output " + shell_word(target) +
                              " --up " + (z_up ? "z" : "y") + " > " + shell_word(target.string() + ".log") + " 2>&1";
  if (std::system(command.c_str()) != 0) stop(command + " failed");
}

using ModelPointer = std::shared_ptr<const model::ModelFile>;

/// The points as COPC, shown in place.
ModelPointer open_in_place(const fs::path& scan, const fs::path& tree) {
  bench::value_or_exit(exporter::export_scan(scan, tree, {}));
  auto file = std::make_unique<const FileSource>(bench::value_or_exit(PositionedFile::open(tree)), tree);
  return std::make_shared<const model::ModelFile>(bench::value_or_exit(
      point_tree::open_in_place(point_tree::TreeFormat::kCopc, std::move(file), nullptr, {}, nullptr)));
}

/// The model of the kept points of a scan. `path`: of its files, without extension.
ModelPointer model_of(const LabPoints& kept, const fs::path& path, const Options& options) {
  if (!options.model.empty()) return bench::open_or_exit(options.model);
  const fs::path scan = path.string() + ".ply";
  if (!write_ply(kept, scan)) stop(scan.string() + " cannot be written");
  if (options.in_place) return open_in_place(scan, path.string() + ".copc.laz");
  const fs::path target = path.string() + ".surf";
  build(scan, target, kept.z_up, options.builder);
  return bench::open_or_exit(target);
}

/// The renderers of all kernels, and the model that they draw.
class Pictures {
 public:
  explicit Pictures(const std::vector<double>& sigmas) {
    for (const double sigma : sigmas) {
      const std::string defines = sigma == SURFCAST_KERNEL_SIGMA ? "" : kernel_defines(sigma);
      threads_.push_back(std::make_unique<RendererThread>(render::RendererConfig{.shader_defines = defines}));
    }
  }

  void open(ModelPointer model) {
    for (const auto& thread : threads_) {
      thread->run([&](render::Renderer& renderer) {
        if (model_) renderer.release_model(*model_);
      });
    }
    model_ = std::move(model);
  }

  std::vector<SrgbPicture> draw(picture::PictureRequest request) {
    request.silhouettes = true;
    std::vector<SrgbPicture> images;
    for (const auto& thread : threads_) {
      thread->run([&](render::Renderer& renderer) {
        images.push_back(picture_of(bench::draw_or_exit(renderer, model_, request).image));
      });
    }
    return images;
  }

 private:
  std::vector<std::unique_ptr<RendererThread>> threads_;
  ModelPointer model_;
};

LeaveOutResult study(const PlacedScan& scan, const Options& options, const fs::path& folder, Pictures& pictures) {
  if (!scan.place) stop(scan.path.string() + " does not begin with ground:, sweep:, object:, room: or sensor:");
  LabPoints points = bench::value_or_exit(read_points(scan.path));
  if (points.size() < 2) stop(scan.path.string() + " has fewer than two points");
  if (points.colors.empty()) points.colors = intensity_levels(points.intensities);
  if (points.colors.empty() && !options.pictures.empty()) points.colors = colors_for(points);
  const std::string name = scan.path.stem().string();
  const auto make_model = [&](const LabPoints& kept) {
    ModelPointer model = model_of(kept, folder / (name + ".kept"), options);
    pictures.open(model);
    return model;
  };
  return study_points(name, points, *scan.place, make_model,
                      [&](const NamedCamera& camera, const picture::PictureRequest& request) {
                        std::vector<SrgbPicture> drawn = pictures.draw(request);
                        if (!options.pictures.empty()) {
                          reference::write_ppm(options.pictures / (name + " " + camera.name + ".ppm"), drawn.front());
                        }
                        return drawn;
                      });
}

void print(const LeaveOutFigures& f, const std::vector<double>& sigmas) {
  std::printf(
      "%-28s %8llu points  off surface %5.1f %%  hidden %6.2f %%  missing %5.2f %%  surface hidden %6.2f %%  "
      "widest %5.1f",
      f.scan.c_str(), static_cast<unsigned long long>(f.points), f.off_surface, f.hidden, f.missing, f.surface_hidden,
      f.largest_radius);
  for (size_t k = 0; k < f.colors.size(); ++k) {
    std::printf("  sigma %.2f r: colour %.2f, near %.2f", sigmas[k], f.colors[k], f.near_colors[k]);
  }
  std::printf("\n");
  std::fflush(stdout);
}

void write_docs(const LeaveOutReport& report, const Options& options) {
  std::optional<LeaveOutReport> before;
  if (!options.before.empty()) {
    before = report_of(content_of(options.before));
    if (!before) stop(options.before.string() + " is no report of this program");
  }
  const fs::path page = options.docs / kResultsPage;
  write(page, bench::value_or_exit(
                  with_section(content_of(page), kLeaveOutBegin, kLeaveOutEnd, markdown_of(report, before))));
}

void run(const Options& options) {
  const fs::path folder = options.keep.empty()
                              ? fs::temp_directory_path() / ("surfcast_leave_out_" + std::to_string(getpid()))
                              : options.keep;
  fs::create_directories(folder);
  Pictures pictures(options.sigmas);
  LeaveOutReport report{options.sigmas, {}};
  std::vector<LeaveOutResult> results;
  for (const std::string& argument : options.scans) {
    results.push_back(study(placed_scan(argument), options, folder, pictures));
    report.scans.push_back(figures_of(results.back()));
    print(report.scans.back(), options.sigmas);
  }
  if (options.keep.empty()) fs::remove_all(folder);
  if (!options.report.empty()) write(options.report, json_of(report, results));
  if (!options.docs.empty()) write_docs(report, options);
}

int main_of(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Leaves out one point in five of each scan, builds a model of the others, and looks for the points that "
      "were left out: hidden, missing, or seen, and in which colour."};
  app.add_option("scans", options.scans,
                 "scans as PLACE:PATH; PLACE, ground, sweep, object, room or sensor, chooses "
                 "the cameras")
      ->required();
  app.add_option("--sigma", options.sigmas,
                 "standard deviations of the kernels that colours are compared with, in radii")
      ->delimiter(',')
      ->check(CLI::Range(0.05, 2.0));
  auto* builder =
      app.add_option("--builder", options.builder, "a surfcastd that builds the models in place of this build")
          ->check(CLI::ExistingFile);
  auto* model =
      app.add_option("--model", options.model, "the model of the kept points of a single scan, instead of building one")
          ->check(CLI::ExistingFile)
          ->excludes(builder);
  app.add_flag("--in-place", options.in_place, "show the kept points in place, as COPC, instead of building a model")
      ->excludes(builder)
      ->excludes(model);
  app.add_option("--keep", options.keep, "folder in which the kept points and the models stay");
  app.add_option("--pictures", options.pictures,
                 "folder for what the cameras see, as PPM; scans without colours get some for it")
      ->check(CLI::ExistingDirectory);
  app.add_option("--report", options.report, "file for the figures as JSON");
  auto* docs = app.add_option("--docs", options.docs, "folder whose laboratory.md gets the table")
                   ->check(CLI::ExistingDirectory);
  app.add_option("--before", options.before, "an earlier report, whose figures stand beside the new ones")
      ->check(CLI::ExistingFile)
      ->needs(docs);
  CLI11_PARSE(app, argc, argv);
  if (!options.model.empty() && options.scans.size() != 1) stop("--model needs a single scan");
  run(options);
  return 0;
}

}  // namespace
}  // namespace surfcast::lab

int main(int argc, char** argv) {
  return surfcast::lab::main_of(argc, argv);
}
