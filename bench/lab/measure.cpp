#include "lab/measure.h"

#include <map>

#include "bench_support.h"

namespace surfcast::lab {
namespace {

/// The times of the frames of one method.
struct Times {
  std::vector<double> frames;
  std::vector<double> processor;
  std::map<std::string, std::vector<double>> stages;

  void add(const DrawnPicture& drawn) {
    frames.push_back(drawn.milliseconds);
    processor.push_back(drawn.processor_milliseconds);
    for (const picture::StageTime& stage : drawn.stages) stages[stage.name].push_back(stage.milliseconds);
  }
  [[nodiscard]] std::vector<picture::StageTime> stage_medians(const std::vector<picture::StageTime>& order) const {
    std::vector<picture::StageTime> medians;
    for (const picture::StageTime& stage : order) medians.push_back({stage.name, bench::median(stages.at(stage.name))});
    return medians;
  }
};

double flicker_of(const std::string& method, const Subject& subject, Methods& methods) {
  std::vector<SrgbPicture> drawn;
  for (const picture::PictureRequest& request : subject.path) drawn.push_back(methods.draw(method, request).picture);
  return flicker(drawn, subject.ideal_path);
}

Measurement summary(const std::string& method, const DrawnPicture& drawn, const Times& times, const Subject& subject) {
  Measurement m;
  m.method = method;
  m.milliseconds = bench::median(times.frames);
  m.processor_milliseconds = bench::median(times.processor);
  m.stages = times.stage_medians(drawn.stages);
  m.surfels_per_second = 1e3 * static_cast<double>(subject.model->info().surfels) / m.milliseconds;
  m.splats = drawn.splats;
  m.errors = picture_errors(drawn.picture, subject.ideal);
  return m;
}

}  // namespace

SceneResult measure(const Subject& subject, int frames, const std::filesystem::path& pictures, Methods& methods) {
  const std::vector<MethodFacts> facts = Methods::all();
  std::vector<Times> times(facts.size());
  std::vector<DrawnPicture> last(facts.size());
  for (int frame = -1; frame < frames; ++frame) {  // the first frame loads blocks and compiles shaders
    for (size_t i = 0; i < facts.size(); ++i) {
      last[i] = methods.draw(facts[i].name, subject.request);
      if (frame >= 0) times[i].add(last[i]);
    }
  }
  const auto keep = [&](const std::string& name, const SrgbPicture& picture) {
    if (!pictures.empty()) write_ppm(pictures / (subject.name + "." + name + ".ppm"), picture);
  };
  keep("ideal", subject.ideal);
  SceneResult result{subject.name, subject.about, subject.model->info().surfels, {}};
  for (size_t i = 0; i < facts.size(); ++i) {
    result.measurements.push_back(summary(facts[i].name, last[i], times[i], subject));
    result.measurements.back().flicker = flicker_of(facts[i].name, subject, methods);
    keep(std::to_string(i), last[i].picture);
  }
  return result;
}

LeaveOutFigures measure_left_out(const LabScene& scene, const std::filesystem::path& folder, Methods& methods) {
  const LabPoints points = colored_points(scene.scan);
  const auto make_model = [&](const LabPoints& kept) {
    const std::filesystem::path scan = folder / (scene.name + ".kept.ply");
    write_or_exit(kept, scan);
    std::shared_ptr<const model::ModelFile> model = built_model(scan, folder, kept.z_up);
    methods.open(model);
    return model;
  };
  const auto draw = [&](const NamedCamera&, const picture::PictureRequest& request) {
    std::vector<SrgbPicture> pictures;
    for (const MethodFacts& method : Methods::all()) pictures.push_back(methods.draw(method.name, request).picture);
    return pictures;
  };
  return figures_of(study_points(scene.name, points, *scene.place, make_model, draw));
}

}  // namespace surfcast::lab
