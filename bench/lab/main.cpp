// laboratory: draws a set of scenes with every method and measures their time and error; see --help.

#include <CLI/CLI.hpp>

#include "bench_support.h"
#include "lab/export_scene.h"
#include "lab/measure.h"
#include "lab/plots.h"
#include "lab/report.h"
#include "lab/text_file.h"

namespace surfcast::lab {
namespace {

namespace fs = std::filesystem;

struct Options {
  int frames = 7;
  int path_frames = 6;
  std::vector<std::string> scenes;
  std::vector<std::string> scans;  ///< PLACE:PATH or PATH
  fs::path docs;
  fs::path pictures;
  fs::path exported;
};

/// Replaces the results in the documentation: the section of kResultsPage, laboratory.json and the plot.
void write_docs(const LabResults& results, const fs::path& docs) {
  const fs::path page = docs / kResultsPage;
  const std::string text =
      bench::value_or_exit(with_section(content_of(page), kResultsBegin, kResultsEnd, markdown_of(results)));
  write_or_exit(page, text);
  write_or_exit(docs / "laboratory.json", json_of(results));
  write_or_exit(docs / "images" / "laboratory.svg", svg_of(results));
}

LabResults run(const Options& options) {
  const fs::path folder = fs::temp_directory_path() / ("surfcast_laboratory_" + std::to_string(getpid()));
  fs::create_directories(folder);
  for (const fs::path& output : {options.pictures, options.exported}) {
    if (!output.empty()) fs::create_directories(output);
  }
  Methods methods;
  LabResults results{methods.device(), options.frames, Methods::all(), {}};
  std::vector<LabScene> scenes;
  for (const std::string& name : options.scenes) scenes.push_back(make_lab_scene(name));
  for (const std::string& scan : options.scans) scenes.push_back(scan_scene(placed_scan(scan)));
  for (const LabScene& scene : scenes) {
    const Subject subject = prepare(scene, folder, options.path_frames, methods);
    if (!options.exported.empty()) export_scene(subject, options.exported);
    results.scenes.push_back(measure(subject, options.frames, options.pictures, methods));
    if (scene.place) results.scenes.back().left_out = measure_left_out(scene, folder, methods);
    for (const Measurement& m : results.scenes.back().measurements) {
      std::printf("%-18s %-15s %8.1f ms, processor %8.1f ms %6.2f dB  ssim %.4f  worst %5.1f dB  flicker %5.2f\n",
                  scene.name.c_str(), m.method.c_str(), m.milliseconds, m.processor_milliseconds, m.errors.psnr,
                  m.errors.ssim, m.errors.worst_tile, m.flicker);
    }
    std::fflush(stdout);
  }
  fs::remove_all(folder);
  return results;
}

int main_of(int argc, char** argv) {
  Options options;
  CLI::App app{"Draws scenes with every method and reports time and error as tables, plots and JSON."};
  app.add_option("scans", options.scans,
                 "scans or models, each measured against its own supersampled picture; as PLACE:PATH (ground, sweep, "
                 "object, room or sensor) also by points that are left out");
  app.add_option("--frames", options.frames, "number of frames; times are medians")->check(CLI::Range(1, 1000));
  app.add_option("--path-frames", options.path_frames, "length of the slow camera path")->check(CLI::Range(2, 1000));
  app.add_option("--scenes", options.scenes, "names of the scenes (default: all)")
      ->delimiter(',')
      ->check(CLI::IsMember(lab_scene_names()));
  app.add_option("--docs", options.docs, "folder whose laboratory.md, laboratory.json and plot are replaced")
      ->check(CLI::ExistingDirectory);
  app.add_option("--pictures", options.pictures, "folder for all pictures, as PPM");
  app.add_option("--export", options.exported,
                 "folder for the scenes, as other programs can draw them, and for laboratory.json");
  CLI11_PARSE(app, argc, argv);
  if (options.scenes.empty()) options.scenes = lab_scene_names();
  const LabResults results = run(options);
  if (!options.docs.empty()) write_docs(results, options.docs);
  if (!options.exported.empty()) write_or_exit(options.exported / "laboratory.json", json_of(results));
  return 0;
}

}  // namespace
}  // namespace surfcast::lab

int main(int argc, char** argv) {
  return surfcast::lab::main_of(argc, argv);
}
