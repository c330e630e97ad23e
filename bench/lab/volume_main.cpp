// volume_laboratory: draws volumes and Gaussian models with every method and measures their time and error; see --help.

#include <CLI/CLI.hpp>

#include <unistd.h>

#include "base/stopwatch.h"
#include "bench_support.h"
#include "lab/report.h"
#include "lab/text_file.h"
#include "lab/volume_methods.h"
#include "lab/volume_report.h"

namespace surfcast::lab {
namespace {

namespace fs = std::filesystem;
using reference::Reconstruction;
using render::Renderer;

constexpr int kMiddle = 96;  ///< side of the part of a picture of a file that is compared, pixels

struct Options {
  int frames = 3;
  int side = 1024;  ///< of pictures of files, pixels
  std::vector<std::string> grids;
  bool analytic = true;
  fs::path docs;
  fs::path exported;
};

/// Medians of the times of a drawing, after one that loads blocks and compiles shaders.
struct Timed {
  LightPicture picture;
  double milliseconds = 0;
  double processor_milliseconds = 0;
};
Timed timed(int frames, const std::function<LightPicture()>& draw) {
  Timed result{draw()};
  std::vector<double> times;
  std::vector<double> processor;
  for (int frame = 0; frame < frames; ++frame) {
    const Stopwatch watch;
    const double start = bench::processor_ms();
    result.picture = draw();
    times.push_back(watch.milliseconds());
    processor.push_back(bench::processor_ms() - start);
  }
  result.milliseconds = bench::median(times);
  result.processor_milliseconds = bench::median(processor);
  return result;
}

/// Programs in double precision are slow and drawn once.
template <typename Subject>
SceneResult measure(Renderer& renderer, const Subject& subject, const LightPicture& ideal,
                    const std::vector<LightMethod<Subject>>& methods, int frames,
                    double (*psnr)(const LightPicture&, const LightPicture&)) {
  SceneResult scene{subject.name, subject.about, subject.model->info().surfels, {}};
  for (const LightMethod<Subject>& method : methods) {
    const Timed drawn = timed(method.facts.plain ? 1 : frames, [&] { return method.draw(renderer, subject); });
    Measurement m;
    m.method = method.facts.name;
    m.milliseconds = drawn.milliseconds;
    m.processor_milliseconds = drawn.processor_milliseconds;
    m.errors.psnr = psnr(drawn.picture, ideal);
    std::printf("%-16s %-20s processor %8.1f ms %6.2f dB\n", scene.name.c_str(), m.method.c_str(),
                m.processor_milliseconds, m.errors.psnr);
    std::fflush(stdout);
    scene.measurements.push_back(m);
  }
  renderer.release_model(*subject.model);
  return scene;
}

LightPicture middle_of(const LightPicture& picture) {
  return inner_part(picture, (picture.width - kMiddle) / 2);
}

void export_picture(const fs::path& path, const LightPicture& picture) {
  if (!write_ppm(path, encode_codes(picture))) std::exit(1);
}

FileResult measure_file(Renderer& renderer, const VolumeSubject& subject, const Options& options) {
  const Timed drawn = timed(options.frames, [&] { return draw_light(renderer, subject.model, subject.request); });
  FileResult result{subject.name,
                    subject.about,
                    options.side,
                    drawn.milliseconds,
                    drawn.processor_milliseconds,
                    covered_psnr(middle_of(drawn.picture), fine_middle(subject, kMiddle, Reconstruction::kCatmullRom))};
  std::printf("%-40s processor %8.1f ms %6.2f dB\n", result.name.c_str(), result.processor_milliseconds, result.psnr);
  std::fflush(stdout);
  if (!options.exported.empty()) {
    export_volume(subject, options.exported);
    export_picture(options.exported / (subject.name + ".ours.ppm"), drawn.picture);
    export_picture(options.exported / (subject.name + ".ideal.ppm"),
                   fine_middle(subject, kMiddle, Reconstruction::kTrilinear));
  }
  renderer.release_model(*subject.model);
  return result;
}

template <typename Subject>
std::vector<MethodFacts> facts_of(const std::vector<LightMethod<Subject>>& methods) {
  std::vector<MethodFacts> facts;
  for (const LightMethod<Subject>& method : methods) facts.push_back(method.facts);
  return facts;
}

VolumeResults run(const Options& options, const fs::path& folder) {
  const std::unique_ptr<Renderer> renderer = bench::value_or_exit(Renderer::create({}));
  const std::string device = renderer->device().renderer;
  VolumeResults results{{device, options.frames, facts_of(volume_methods()), {}},
                        {device, options.frames, facts_of(gaussian_methods()), {}},
                        {}};
  for (const std::string& grid : options.grids) {
    results.files.push_back(measure_file(*renderer, volume_of_file(grid, options.side, folder), options));
  }
  if (!options.analytic) return results;
  for (const VolumeSubject& subject : analytic_volumes(folder)) {
    results.volumes.scenes.push_back(
        measure(*renderer, subject, *subject.ideal, volume_methods(), options.frames, reference::covered_psnr));
  }
  for (const GaussianSubject& subject : gaussian_subjects(folder)) {
    results.gaussians.scenes.push_back(measure(*renderer, subject, subject.ideal, gaussian_methods(), options.frames,
                                               reference::covered_psnr_of_codes));
  }
  return results;
}

void write_docs(const VolumeResults& results, const fs::path& docs) {
  const fs::path page = docs / kResultsPage;
  write_or_exit(page,
                bench::value_or_exit(with_section(content_of(page), kVolumesBegin, kVolumesEnd, markdown_of(results))));
  write_or_exit(docs / "laboratory_volumes.json", json_of(results));
  write_or_exit(docs / "images" / "laboratory_volumes.svg", svg_over_processor_time(results.volumes));
  write_or_exit(docs / "images" / "laboratory_gaussians.svg", svg_over_processor_time(results.gaussians));
}

int main_of(int argc, char** argv) {
  Options options;
  CLI::App app{"Draws volumes and Gaussian models with every method and reports time and error."};
  app.add_option("grids", options.grids,
                 "files with grids, as PRESET:PATH or PATH; each is measured against 16 samples a spacing");
  app.add_option("--frames", options.frames, "number of frames; times are medians")->check(CLI::Range(1, 1000));
  app.add_option("--side", options.side, "of the pictures of files, pixels")->check(CLI::Range(256, 8192));
  app.add_flag("!--files-only", options.analytic, "leave out the analytic fields and the Gaussian models");
  app.add_option("--docs", options.docs, "folder whose laboratory.md, laboratory_volumes.json and plots are replaced")
      ->check(CLI::ExistingDirectory);
  app.add_option("--export", options.exported,
                 "folder for the grids, their views and their pictures, for other programs, and for volumes.json");
  CLI11_PARSE(app, argc, argv);
  const fs::path folder = fs::temp_directory_path() / ("surfcast_volume_laboratory_" + std::to_string(getpid()));
  fs::create_directories(folder);
  if (!options.exported.empty()) fs::create_directories(options.exported);
  const VolumeResults results = run(options, folder);
  fs::remove_all(folder);
  if (!options.docs.empty()) write_docs(results, options.docs);
  if (!options.exported.empty()) write_or_exit(options.exported / "volumes.json", json_of(results));
  return 0;
}

}  // namespace
}  // namespace surfcast::lab

int main(int argc, char** argv) {
  return surfcast::lab::main_of(argc, argv);
}
