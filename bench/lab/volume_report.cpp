#include "lab/volume_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "lab/markdown_table.h"
#include "lab/plots.h"

namespace surfcast::lab {
namespace {

using nlohmann::ordered_json;

std::string methods_of(const LabResults& results) {
  std::string text = header({"method", ""});
  for (const MethodFacts& method : results.methods) {
    text += row({method.name, method.about + (method.plain ? ", in double precision" : "")});
  }
  return text + "\n";
}

/// Processor time and PSNR; the highest of a scene is bold.
std::string cell_of(const SceneResult& scene, const Measurement& m) {
  double best = 0;
  for (const Measurement& other : scene.measurements) best = std::max(best, other.errors.psnr);
  const std::string error = number(m.errors.psnr, 1) + " dB";
  return number(m.processor_milliseconds, 0) + " ms, " + (m.errors.psnr == best ? "**" + error + "**" : error);
}

std::string table_of(const LabResults& results) {
  std::vector<std::string> names{"scene", ""};
  for (const MethodFacts& method : results.methods) names.push_back(method.name);
  std::string text = header(names);
  for (const SceneResult& scene : results.scenes) {
    std::vector<std::string> cells{scene.name, scene.about};
    for (const Measurement& m : scene.measurements) cells.push_back(cell_of(scene, m));
    text += row(cells);
  }
  return text + "\n";
}

std::string table_of(const std::vector<FileResult>& files) {
  if (files.empty()) return {};
  std::string text = header({"file and preset", "samples", "pixels", "processor time", "error"});
  for (const FileResult& file : files) {
    text += row({file.name, file.about, std::to_string(file.side) + " x " + std::to_string(file.side),
                 number(file.processor_milliseconds, 0) + " ms", number(file.psnr, 1) + " dB"});
  }
  return text + "\n";
}

ordered_json scenes_of(const LabResults& results) {
  ordered_json scenes = ordered_json::array();
  for (const SceneResult& scene : results.scenes) {
    ordered_json measurements = ordered_json::array();
    for (const Measurement& m : scene.measurements) {
      measurements.push_back({{"method", m.method},
                              {"milliseconds", m.milliseconds},
                              {"processor_milliseconds", m.processor_milliseconds},
                              {"psnr", m.errors.psnr}});
    }
    scenes.push_back({{"scene", scene.name}, {"about", scene.about}, {"measurements", measurements}});
  }
  return scenes;
}

}  // namespace

std::string markdown_of(const VolumeResults& results) {
  return "Device: " + results.volumes.device + "; medians of " + std::to_string(results.volumes.frames) +
         " frames, processor time.\nPSNR over the pixels that either picture covers.\n\n" +
         methods_of(results.volumes) + table_of(results.volumes) +
         "![Volumes: time against error](images/laboratory_volumes.svg)\n\n" + methods_of(results.gaussians) +
         table_of(results.gaussians) + "![Gaussian models: time against error](images/laboratory_gaussians.svg)\n\n" +
         table_of(results.files);
}

std::string json_of(const VolumeResults& results) {
  ordered_json files = ordered_json::array();
  for (const FileResult& file : results.files) {
    files.push_back({{"file", file.name},
                     {"side", file.side},
                     {"milliseconds", file.milliseconds},
                     {"processor_milliseconds", file.processor_milliseconds},
                     {"psnr", file.psnr}});
  }
  return ordered_json{{"device", results.volumes.device},
                      {"frames", results.volumes.frames},
                      {"volumes", scenes_of(results.volumes)},
                      {"gaussians", scenes_of(results.gaussians)},
                      {"files", files}}
             .dump(1) +
         "\n";
}

std::string svg_over_processor_time(LabResults results) {
  for (SceneResult& scene : results.scenes) {
    for (Measurement& m : scene.measurements) m.milliseconds = m.processor_milliseconds;
  }
  return svg_of(results);
}

}  // namespace surfcast::lab
