// budget_lab MODEL...: how near pictures come to the error or the time that is asked of them.
// For each model, four views (whole, from near, grazing, from the ground) at 1280 x 720 through a service as
// `surfcastd render` has it. A row for each error: asked, expected, and true PSNR against the picture of spacing 0, in
// dB over covered pixels; a row for each time: asked, expected, and what drawing and encoding take at the chosen
// spacing, the median of three. Then the time of the search over that of the finest picture. The last line has the
// pictures within the goals: -1.5 to +4 dB, and a quarter of the time, or less at the finest level; and those of which
// the answer says that they take longer.

#include <cmath>
#include <cstdio>
#include <functional>
#include <future>
#include <glm/geometric.hpp>
#include <memory>
#include <string>
#include <vector>

#include "access/authorization.h"
#include "bench_support.h"
#include "picture_error.h"
#include "service/model_catalogue.h"
#include "service/render_service.h"
#include "service/renderer_factories.h"

namespace {

using namespace surfcast;
using geometry::Camera;

struct View {
  const char* name;
  Camera camera;
};

std::vector<View> views_of(const Camera& whole) {
  const glm::dvec3 sight = whole.focal_point - whole.position;
  const double distance = glm::length(sight);
  const glm::dvec3 up = glm::normalize(whole.view_up);
  const glm::dvec3 level = glm::normalize(sight - glm::dot(sight, up) * up);
  Camera near = whole;
  near.position = whole.focal_point - 0.25 * sight;
  Camera grazing = whole;
  grazing.position = whole.focal_point - 0.6 * distance * (std::cos(0.09) * level - std::sin(0.09) * up);
  Camera ground = whole;
  ground.position = whole.focal_point - 0.12 * distance * level + 0.01 * distance * up;
  ground.focal_point = ground.position + distance * level;
  ground.view_angle = 60;
  return {{"whole", whole}, {"near", near}, {"grazing", grazing}, {"ground", ground}};
}

double drawing_and_encoding_ms(const service::EncodedPicture& picture) {
  return bench::drawing_ms(*picture.frame) + picture.encode_ms;
}

/// Milliseconds of a stage; 0 if there is none.
double stage_ms(const service::EncodedPicture& picture, const char* name) {
  for (const picture::StageTime& stage : picture.stats.stages) {
    if (stage.name == name) return stage.milliseconds;
  }
  return 0;
}

struct Share {
  int met = 0;
  int all = 0;

  void count(bool good) {
    met += int{good};
    ++all;
  }
};

class Lab {
 public:
  explicit Lab(const std::string& path)
      : path_(path),
        models_(std::make_unique<service::ModelCatalogue>(std::vector<service::NamedModel>{{"model", path}},
                                                          std::vector<std::filesystem::path>())),
        service_(bench::value_or_exit(service::RenderService::start(
            *models_, service::catalogue_renderers(*models_, service::local_renderers({}), service::ShaderWarmUp::kOff),
            {}))) {}

  void run() {
    service::PictureJob first = job();
    first.request.width = first.request.height = 16;
    first.request.spacing = 1e6;
    for (const View& view : views_of(draw(first).camera)) {
      camera_ = view.camera;
      draw(job());  // blocks and shaders
      const service::EncodedPicture finest = draw(job());
      for (const double error : {34.0, 40.0, 46.0}) measure_error(view, error, finest);
      for (const double time : {100.0, 200.0, 400.0}) measure_time(view, time, finest);
    }
  }

  static Share errors;
  static Share times;
  static int said_longer;

 private:
  [[nodiscard]] service::PictureJob job() const {
    service::PictureJob job{access::Rights::unlimited().authorize(models_->names().front())};
    job.request.camera = camera_;
    job.request.silhouettes = true;
    job.keep_frame = true;
    return job;
  }

  service::EncodedPicture draw(const service::PictureJob& job) {
    std::promise<Result<service::EncodedPicture>> promise;
    service_->draw(0, job, [&](Result<service::EncodedPicture> picture) { promise.set_value(std::move(picture)); });
    return bench::value_or_exit(promise.get_future().get());
  }

  /// A picture with the spacing and the render scale of another one.
  service::EncodedPicture draw_as(const service::EncodedPicture& picture) {
    service::PictureJob alone = job();
    alone.request.spacing = picture.spacing;
    alone.request.render_scale = picture.render_scale;
    return draw(alone);
  }

  void print(const View& view, const char* what, double asked, double expected, double found, bool good,
             const service::EncodedPicture& picture, const service::EncodedPicture& finest) {
    std::printf("| %s | %s | %s %.0f | %.1f | %.1f | %s | %.3f | %.2f | %.2f |\n",
                path_.substr(path_.find_last_of('/') + 1).c_str(), view.name, what, asked, expected, found,
                good ? "yes" : "no", picture.spacing, picture.render_scale,
                stage_ms(picture, "search") / drawing_and_encoding_ms(finest));
    std::fflush(stdout);
  }

  void measure_error(const View& view, double asked, const service::EncodedPicture& finest) {
    service::PictureJob request = job();
    request.request.error = asked;
    const service::EncodedPicture picture = draw(request);
    const double psnr = bench::psnr(picture.frame->image, finest.frame->image);
    const bool good = psnr > asked - 1.5 && (psnr < asked + 4 || picture.spacing >= 256);
    errors.count(good);
    print(view, "dB", asked, picture.expected_error, psnr, good, picture, finest);
  }

  void measure_time(const View& view, double asked, const service::EncodedPicture& finest) {
    service::PictureJob request = job();
    request.request.time_ms = asked;
    const service::EncodedPicture picture = draw(request);
    std::vector<double> rounds;
    for (int i = 0; i < 3; ++i) rounds.push_back(drawing_and_encoding_ms(draw_as(picture)));
    const double found = bench::median(rounds);
    const bool finest_level = picture.spacing == 0 && picture.render_scale == 1;
    const bool good = found < 1.25 * asked && (found > 0.75 * asked || finest_level);
    times.count(good);
    said_longer += int{!good && picture.expected_ms > 1.25 * asked};
    print(view, "ms", asked, picture.expected_ms, found, good, picture, finest);
  }

  std::string path_;
  std::optional<Camera> camera_;
  std::unique_ptr<service::ModelCatalogue> models_;
  std::unique_ptr<service::RenderService> service_;
};

Share Lab::errors;
Share Lab::times;
int Lab::said_longer = 0;

}  // namespace

int main(int argc, char** argv) {
  std::printf(
      "| model | view | asked | expected | true | met | spacing | render scale | search / finest "
      "|\n|---|---|---|---|---|---|---|---|---|\n");
  for (int i = 1; i < argc; ++i) Lab(argv[i]).run();
  std::printf("errors: %d of %d, times: %d of %d, and %d that were said to take longer\n", Lab::errors.met,
              Lab::errors.all, Lab::times.met, Lab::times.all, Lab::said_longer);
  return 0;
}
