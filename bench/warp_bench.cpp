// warp_bench MODEL... [opacity=NUMBER]: how near frames that are warped by their depth come to the picture of the
// present camera. For each model and movement, a row: PSNR in dB over covered pixels, and the share of pixels that are
// more than 20 levels off, both against the picture at rest of the camera that is shown. Cameras begin with a view of
// the whole model. SURFCAST_KEEP_PICTURES names a folder for the pictures (PPM).

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <memory>
#include <string>
#include <vector>

#include "bench_support.h"
#include "camera_paths.h"
#include "encode/encode_depth.h"
#include "geometry/camera.h"
#include "service/first_look.h"
#include "warp/warp.h"
#include "warp_error.h"

namespace {

using namespace surfcast;
using bench::compare;
using bench::Figures;
using bench::Path;
using bench::pixels_of;
using bench::unwarped;
using bench::value_or_exit;
using geometry::Camera;

constexpr int kWidth = 1280;
constexpr int kHeight = 720;
constexpr int kTexelsAtRest = 160;
constexpr int kTexelsInMotion = 80;

void keep(const std::string& name, const warp::Pixels& pixels) {
  const char* folder = std::getenv("SURFCAST_KEEP_PICTURES");
  if (folder == nullptr) return;
  std::ofstream file(std::string(folder) + "/" + name + ".ppm", std::ios::binary);
  file << "P6\n" << pixels.width << " " << pixels.height << "\n255\n";
  for (size_t i = 0; i < pixels.bytes.size(); i += 4) file.write(reinterpret_cast<const char*>(&pixels.bytes[i]), 3);
}

class Subject {
 public:
  Subject(const std::string& path, double opacity)
      : opacity_(opacity), model_(bench::open_or_exit(path)), renderer_(value_or_exit(render::Renderer::create({}))) {
    picture::PictureRequest request;
    request.width = request.height = 16;
    request.spacing = 1e6;
    first_ = bench::draw_or_exit(*renderer_, model_, request).camera;
  }

  [[nodiscard]] const Camera& first() const { return first_; }

  [[nodiscard]] picture::Frame rest(const Camera& camera) const {
    picture::PictureRequest request = bench::request_at_rest(camera, kWidth, kHeight);
    request.opacity = opacity_;
    request.depth_texels = kTexelsAtRest;
    return draw(request);
  }

  [[nodiscard]] picture::Frame motion(const Camera& camera) const {
    picture::PictureRequest request;
    request.camera = camera;
    request.width = kWidth / 2;
    request.height = kHeight / 2;
    request.spacing = 2;
    request.normalization = picture::Normalization::kSurfel;
    request.blends_behind = true;
    request.opacity = opacity_;
    request.depth_texels = kTexelsInMotion;
    return draw(request);
  }

 private:
  /// As a server draws it.
  [[nodiscard]] picture::Frame draw(const picture::PictureRequest& request) const {
    return bench::draw_or_exit(*renderer_, model_, service::with_first_look(request, model_->info()));
  }

  double opacity_;
  std::shared_ptr<const model::ModelFile> model_;
  std::unique_ptr<render::Renderer> renderer_;
  Camera first_;
};

struct Warpable {
  warp::WarpFrame frame;
  size_t depth_bytes = 0;
};

/// A frame as a client has it, after its depth has been encoded and decoded.
Warpable warpable(const picture::Frame& drawn) {
  const int width = drawn.image.width;
  const int height = drawn.image.height;
  const geometry::CameraFrame camera = value_or_exit(geometry::make_camera_frame(drawn.camera, width, height));
  const auto encoded = encode::encode_depth(drawn.depth, drawn.image.width < kWidth ? 3000 : 6000);
  if (!encoded) return {{pixels_of(drawn.image), camera, {}, {}, false}, 0};
  wire::DepthPlane plane;
  plane.set_width(static_cast<uint32_t>(encoded->width));
  plane.set_height(static_cast<uint32_t>(encoded->height));
  plane.set_cell(static_cast<uint32_t>(encoded->cell));
  plane.set_first(encoded->first);
  plane.set_last(encoded->last);
  plane.set_codes(encoded->codes.data(), encoded->codes.size());
  plane.set_seen_through(encoded->seen_through);
  const warp::DepthPlane depth = value_or_exit(warp::decode_depth(plane, width, height));
  return {warp::make_warp_frame(pixels_of(drawn.image), camera, depth), encoded->codes.size()};
}

void print(const Figures& figures) {
  std::printf(" %.1f / %.1f |", figures.psnr, figures.off);
}

/// The first camera, or one that is four times as near.
Camera begin_of(const Subject& subject, bool near) {
  Camera camera = subject.first();
  if (near) camera.position = glm::mix(camera.focal_point, camera.position, 0.25);
  return camera;
}

void measure(const std::string& name, const Subject& subject, bool near) {
  const Camera begin = begin_of(subject, near);
  std::printf(
      "\n| %s | present motion frame | stale rest | rest warped | rest over stale motion | "
      "rest over motion 30 ms off | rest over present motion | processor ms |\n|---|---|---|---|---|---|---|---|\n",
      name.c_str());
  const Warpable rest = warpable(subject.rest(begin));
  const Warpable first_motion = warpable(subject.motion(begin));
  for (const Path& path : bench::paths()) {
    for (const double delay : {0.033, 0.1, 0.3}) {
      const Camera shown = path.at(begin, delay);
      const picture::Frame truth = subject.rest(shown);
      const Warpable nearly = warpable(subject.motion(path.at(begin, delay + 0.03)));
      const Warpable present = warpable(subject.motion(shown));
      const geometry::CameraFrame target = value_or_exit(geometry::make_camera_frame(shown, kWidth, kHeight));
      const auto warped = [&](const Warpable& newest, const Warpable* below) {
        return warp::warp(newest.frame, below ? &below->frame : nullptr, target, {0, 0, 0, 255});
      };
      std::printf("| %s, %.3f s |", path.name.c_str(), delay);
      print(compare(unwarped(present.frame, target), truth.image));
      print(compare(unwarped(rest.frame, target), truth.image));
      print(compare(warped(rest, nullptr), truth.image));
      print(compare(warped(first_motion, &rest), truth.image));
      print(compare(warped(nearly, &rest), truth.image));
      const double begun = bench::processor_ms();
      const warp::Pixels both = warped(present, &rest);
      const double milliseconds = bench::processor_ms() - begun;
      print(compare(both, truth.image));
      std::printf(" %.0f |\n", milliseconds);
      std::fflush(stdout);
      if (delay >= 0.1) {
        const std::string prefix = name.substr(name.find_last_of('/') + 1) + "_" +
                                   path.name.substr(0, path.name.find(',')) + (delay > 0.1 ? "_late" : "");
        keep(prefix + "_truth", pixels_of(truth.image));
        keep(prefix + "_motion", unwarped(present.frame, target));
        keep(prefix + "_rest", warped(rest, nullptr));
        keep(prefix + "_both", both);
        keep(prefix + "_stale", warped(first_motion, &rest));
      }
    }
  }
  std::printf("depth: %zu bytes at rest, %zu in motion\n", rest.depth_bytes, first_motion.depth_bytes);
}

}  // namespace

int main(int argc, char** argv) {
  double opacity = 1;
  for (int i = 1; i < argc; ++i) {
    if (std::strncmp(argv[i], "opacity=", 8) == 0) {
      opacity = std::atof(argv[i] + 8);
      continue;
    }
    const Subject subject(argv[i], opacity);
    measure(argv[i], subject, false);
    measure(std::string(argv[i]) + ", near", subject, true);
  }
  return 0;
}
