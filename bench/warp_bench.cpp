// warp_bench MODEL...: how near frames that are warped by their depth come to the picture of the present camera.
// For each model and movement, a row: PSNR in dB over covered pixels, and the share of pixels that are more than 20
// levels off, both against the picture at rest of the camera that is shown. Cameras begin with a view of the whole
// model. SURFCAST_KEEP_PICTURES names a folder for the pictures (PPM).

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
#include "encode/encode_depth.h"
#include "geometry/camera.h"
#include "warp/warp.h"

namespace {

using namespace surfcast;
using bench::value_or_exit;
using geometry::Camera;

constexpr int kWidth = 1280;
constexpr int kHeight = 720;
constexpr int kTexelsAtRest = 160;
constexpr int kTexelsInMotion = 80;

/// The camera some seconds after `begin`.
using Movement = std::function<Camera(const Camera& begin, double seconds)>;

struct Path {
  std::string name;
  Movement at;
};

glm::dvec3 rotated(const glm::dvec3& v, const glm::dvec3& axis, double degrees) {
  const double angle = glm::radians(degrees);
  return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) + axis * glm::dot(axis, v) * (1 - std::cos(angle));
}

Camera orbit(const Camera& begin, double degrees) {
  Camera camera = begin;
  camera.position =
      begin.focal_point + rotated(begin.position - begin.focal_point, glm::normalize(begin.view_up), degrees);
  return camera;
}

Camera moved(const Camera& begin, const glm::dvec3& by) {
  Camera camera = begin;
  camera.position += by;
  camera.focal_point += by;
  return camera;
}

std::vector<Path> paths() {
  const auto dolly = [](const Camera& begin, double seconds) {
    Camera camera = begin;
    camera.position = begin.focal_point + (begin.position - begin.focal_point) * std::pow(2, -seconds);
    return camera;
  };
  const auto fly = [](const Camera& begin, double seconds) {
    return moved(begin, (begin.focal_point - begin.position) * (0.5 * seconds));
  };
  const auto fly_and_turn = [fly](const Camera& begin, double seconds) {
    Camera camera = fly(begin, seconds);
    camera.focal_point =
        camera.position + rotated(camera.focal_point - camera.position, glm::normalize(begin.view_up), 30 * seconds);
    return camera;
  };
  const auto pan = [](const Camera& begin, double seconds) {
    const glm::dvec3 view = begin.focal_point - begin.position;
    const double height = 2 * glm::length(view) * std::tan(glm::radians(begin.view_angle / 2));
    return moved(begin, glm::normalize(glm::cross(view, begin.view_up)) * (height * seconds));
  };
  return {{"orbit, 45 degrees a second", [](const Camera& c, double s) { return orbit(c, 45 * s); }},
          {"dolly, 2 times a second", dolly},
          {"flight", fly},
          {"flight and turn", fly_and_turn},
          {"pan, a height a second", pan}};
}

struct Figures {
  double psnr = 0;
  double off = 0;  ///< percent
};

/// Over the pixels that `truth` covers.
Figures compare(const warp::Pixels& picture, const picture::Image& truth) {
  double sum = 0;
  size_t off = 0;
  size_t count = 0;
  for (size_t i = 0; i < truth.pixels.size() / 4; ++i) {
    if (truth.pixels[4 * i + 3] == std::byte{0}) continue;
    int largest = 0;
    for (size_t c = 0; c < 3; ++c) {
      const int difference = std::to_integer<int>(truth.pixels[4 * i + c]) - picture.bytes[4 * i + c];
      sum += difference * difference;
      largest = std::max(largest, std::abs(difference));
    }
    off += largest > 20 ? 1 : 0;
    ++count;
  }
  const auto pixels = static_cast<double>(std::max<size_t>(count, 1));
  return {10 * std::log10(255.0 * 255.0 * 3 * pixels / std::max(sum, 1e-9)), 100 * static_cast<double>(off) / pixels};
}

warp::Pixels pixels_of(const picture::Image& image) {
  warp::Pixels pixels{image.width, image.height, std::vector<uint8_t>(image.pixels.size())};
  std::memcpy(pixels.bytes.data(), image.pixels.data(), image.pixels.size());
  return pixels;
}

/// A picture of `target` made of one frame, scaled as a client without depth does it.
warp::Pixels stale(const warp::WarpFrame& frame, const geometry::CameraFrame& target) {
  const warp::DepthPlane none{1, 1, std::max(frame.camera.width, frame.camera.height), {1.0F}};
  const warp::WarpFrame flat{frame.pixels, frame.camera,
                             warp::make_warp_mesh(none, frame.camera.width, frame.camera.height)};
  geometry::CameraFrame same = frame.camera;
  const double scale = static_cast<double>(target.height) / same.height;
  same.width = target.width;
  same.height = target.height;
  same.eta *= scale;
  return warp::warp(flat, nullptr, same, {0, 0, 0, 255});
}

void keep(const std::string& name, const warp::Pixels& pixels) {
  const char* folder = std::getenv("SURFCAST_KEEP_PICTURES");
  if (folder == nullptr) return;
  std::ofstream file(std::string(folder) + "/" + name + ".ppm", std::ios::binary);
  file << "P6\n" << pixels.width << " " << pixels.height << "\n255\n";
  for (size_t i = 0; i < pixels.bytes.size(); i += 4) file.write(reinterpret_cast<const char*>(&pixels.bytes[i]), 3);
}

class Subject {
 public:
  explicit Subject(const std::string& path)
      : model_(bench::open_or_exit(path)), renderer_(value_or_exit(render::Renderer::create({}))) {
    picture::PictureRequest request;
    request.width = request.height = 16;
    request.spacing = 1e6;
    first_ = bench::draw_or_exit(*renderer_, model_, request).camera;
  }

  [[nodiscard]] const Camera& first() const { return first_; }

  [[nodiscard]] picture::Frame rest(const Camera& camera) const {
    picture::PictureRequest request;
    request.camera = camera;
    request.width = kWidth;
    request.height = kHeight;
    request.spacing = 1;
    request.silhouettes = true;
    request.depth_texels = kTexelsAtRest;
    return bench::draw_or_exit(*renderer_, model_, request);
  }

  [[nodiscard]] picture::Frame motion(const Camera& camera) const {
    picture::PictureRequest request;
    request.camera = camera;
    request.width = kWidth / 2;
    request.height = kHeight / 2;
    request.spacing = 2;
    request.normalization = picture::Normalization::kSurfel;
    request.blends_behind = true;
    request.depth_texels = kTexelsInMotion;
    return bench::draw_or_exit(*renderer_, model_, request);
  }

 private:
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
  Warpable result{
      {pixels_of(drawn.image), value_or_exit(geometry::make_camera_frame(drawn.camera, width, height)), {}}};
  const auto encoded = encode::encode_depth(drawn.depth, drawn.image.width < kWidth ? 3000 : 6000);
  if (!encoded) return result;
  wire::DepthPlane plane;
  plane.set_width(static_cast<uint32_t>(encoded->width));
  plane.set_height(static_cast<uint32_t>(encoded->height));
  plane.set_cell(static_cast<uint32_t>(encoded->cell));
  plane.set_first(encoded->first);
  plane.set_last(encoded->last);
  plane.set_codes(encoded->codes.data(), encoded->codes.size());
  result.depth_bytes = encoded->codes.size();
  result.frame.mesh = warp::make_warp_mesh(value_or_exit(warp::decode_depth(plane, width, height)), width, height);
  return result;
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
      "\n| %s | present motion frame | stale rest | stale motion | rest warped | motion warped | "
      "rest over stale motion | rest over present motion | processor ms |\n|---|---|---|---|---|---|---|---|\n",
      name.c_str());
  const Warpable rest = warpable(subject.rest(begin));
  const Warpable first_motion = warpable(subject.motion(begin));
  for (const Path& path : paths()) {
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
      print(compare(stale(present.frame, target), truth.image));
      print(compare(stale(rest.frame, target), truth.image));
      print(compare(warped(rest, nullptr), truth.image));
      print(compare(warped(first_motion, &rest), truth.image));
      print(compare(warped(nearly, &rest), truth.image));
      const double begun = bench::processor_ms();
      const warp::Pixels both = warped(present, &rest);
      const double milliseconds = bench::processor_ms() - begun;
      print(compare(both, truth.image));
      std::printf(" %.0f |\n", milliseconds);
      std::fflush(stdout);
      if (delay == 0.1) {
        const std::string prefix = name.substr(name.find_last_of('/') + 1) + "_" + path.name.substr(0, 4);
        keep(prefix + "_truth", pixels_of(truth.image));
        keep(prefix + "_motion", stale(present.frame, target));
        keep(prefix + "_rest", warped(rest, nullptr));
        keep(prefix + "_both", both);
      }
    }
  }
  std::printf("depth: %zu bytes at rest, %zu in motion\n", rest.depth_bytes, first_motion.depth_bytes);
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const Subject subject(argv[i]);
    measure(argv[i], subject, false);
    measure(std::string(argv[i]) + ", near", subject, true);
  }
  return 0;
}
