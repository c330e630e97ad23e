#include <cmath>
#include <nlohmann/json.hpp>

#include "lab/report.h"

namespace surfcast::lab {
namespace {

using nlohmann::ordered_json;

ordered_json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;  // the PSNR of equal pictures is infinite
  return std::round(value * 1e4) / 1e4;
}

ordered_json json_of(const Measurement& m) {
  ordered_json stages = ordered_json::object();
  for (const picture::StageTime& stage : m.stages) stages[stage.name] = rounded(stage.milliseconds);
  return {{"method", m.method},
          {"milliseconds", rounded(m.milliseconds)},
          {"processor_milliseconds", rounded(m.processor_milliseconds)},
          {"surfels_per_second", std::round(m.surfels_per_second)},
          {"splats", m.splats},
          {"psnr", rounded(m.errors.psnr)},
          {"ssim", rounded(m.errors.ssim)},
          {"worst_tile", rounded(m.errors.worst_tile)},
          {"flicker", rounded(m.flicker)},
          {"stages", stages}};
}

ordered_json json_of(const SceneResult& scene) {
  ordered_json measurements = ordered_json::array();
  for (const Measurement& m : scene.measurements) measurements.push_back(json_of(m));
  ordered_json json{{"scene", scene.name}, {"surfels", scene.surfels}, {"measurements", measurements}};
  if (scene.left_out) {
    json["left_out"] = {{"hidden", rounded(scene.left_out->hidden)}, {"missing", rounded(scene.left_out->missing)}};
    for (const double error : scene.left_out->colors) json["left_out"]["colors"].push_back(rounded(error));
  }
  return json;
}

}  // namespace

std::string json_of(const LabResults& results) {
  ordered_json scenes = ordered_json::array();
  for (const SceneResult& scene : results.scenes) scenes.push_back(json_of(scene));
  return ordered_json{{"device", results.device}, {"frames", results.frames}, {"scenes", scenes}}.dump(1) + "\n";
}

}  // namespace surfcast::lab
