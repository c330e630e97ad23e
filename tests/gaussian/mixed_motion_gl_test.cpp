// Motion over scenes in which things are seen through: a client that warps frames by their depth shows no picture that
// is worse than the newest frame as it is, by more than a decibel. (Of what hardly changes when it moves, as a uniform
// medium does, frames as they are can be nearer: then warped ones are near enough.)

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <string>
#include <vector>

#include "gaussian/mixed_scene_fixture.h"
#include "warp/warp.h"

namespace surfcast::gaussian {
namespace {

constexpr int kMotionWidth = 320;
constexpr int kMotionHeight = 180;
constexpr double kNearEnough = 27;     // dB
constexpr double kLatency = 0.1;       // seconds from a camera to the frame that shows it
constexpr double kForecastOff = 0.03;  // seconds: what is left of it where the server draws ahead

geometry::Camera camera_at(double degrees, double distance, double aside) {
  const double angle = glm::radians(degrees);
  const glm::dvec3 shift(aside, 0, 0);
  return {distance * glm::dvec3(std::sin(angle), 0, std::cos(angle)) + shift, shift, {0, 1, 0}, 30};
}

struct Movement {
  std::string name;
  std::function<geometry::Camera(double)> at;  ///< the camera after some seconds
};

const std::vector<Movement>& movements() {
  static const std::vector<Movement> all{
      {"orbit", [](double t) { return camera_at(45 * t, 5, 0); }},
      {"dolly", [](double t) { return camera_at(0, 5 * std::pow(2, -t), 0); }},
      {"pan", [](double t) { return camera_at(0, 5, 2 * 5 * std::tan(glm::radians(15.0)) * t); }}};
  return all;
}

warp::WarpFrame warp_frame(const picture::Frame& drawn) {
  const picture::Image& image = drawn.image;
  warp::Pixels pixels{image.width, image.height, std::vector<uint8_t>(image.pixels.size())};
  std::memcpy(pixels.bytes.data(), image.pixels.data(), image.pixels.size());
  const warp::DepthPlane plane{drawn.depth.width, drawn.depth.height, drawn.depth.cell, drawn.depth.inverse,
                               drawn.depth.seen_through};
  return warp::make_warp_frame(std::move(pixels), *geometry::make_camera_frame(drawn.camera, image.width, image.height),
                               plane);
}

/// PSNR in dB.
double decibels_of(const std::vector<uint8_t>& picture, const picture::Image& truth) {
  double sum = 0;
  for (size_t i = 0; i < picture.size(); ++i) {
    if (i % 4 == 3) continue;
    const double difference = picture[i] - std::to_integer<int>(truth.pixels[i]);
    sum += difference * difference;
  }
  return 10 * std::log10(255.0 * 255.0 * 0.75 * static_cast<double>(picture.size()) / std::max(sum, 1e-9));
}

class MixedMotionGL : public testing::MixedSceneFixture {
 protected:
  picture::Frame frame_of(const testing::ModelPointer& model, picture::PictureRequest request,
                          const geometry::Camera& camera, bool motion) {
    request.format = picture::PixelFormat::kSrgb8;
    request.camera = camera;
    request.width = kMotionWidth;
    request.height = kMotionHeight;
    request.depth_texels = 80;
    request.blends_behind = motion;
    return testing::draw(*renderer_, model, request);
  }

  void expect_no_worse(const std::vector<std::filesystem::path>& inputs, const picture::PictureRequest& request) {
    const testing::ModelPointer model = build(inputs);
    for (const Movement& movement : movements()) {
      const warp::WarpFrame rest = warp_frame(frame_of(model, request, movement.at(0), false));
      for (const double t : {0.033, 0.1, 0.2, 0.4}) {
        const picture::Frame truth = frame_of(model, request, movement.at(t), false);
        const geometry::CameraFrame target = *geometry::make_camera_frame(movement.at(t), kMotionWidth, kMotionHeight);
        std::vector<uint8_t> plain = rest.pixels.bytes;
        std::vector<uint8_t> shown = warp::warp(rest, nullptr, target, {0, 0, 0, 255}).bytes;
        if (t > kLatency) {
          plain = warp_frame(frame_of(model, request, movement.at(t - kLatency), true)).pixels.bytes;
          const warp::WarpFrame newest = warp_frame(frame_of(model, request, movement.at(t - kForecastOff), true));
          shown = warp::warp(newest, &rest, target, {0, 0, 0, 255}).bytes;
        }
        EXPECT_GT(decibels_of(shown, truth.image), std::min(decibels_of(plain, truth.image) - 1, kNearEnough))
            << movement.name << " " << t;
      }
    }
  }
  static picture::PictureRequest faint() {
    picture::PictureRequest request = request_of();
    request.class_opacities = {{5, 0.4}};
    request.volumes.transfer.points = {{0, kCube, 0.15}, {255, kCube, 0.15}};
    request.volumes.transfer.spacing = 1;
    return request;
  }
};

TEST_F(MixedMotionGL, OverGaussians) {
  expect_no_worse({testing::write_ply(folder_ / "fog.ply", reference::make_gaussian_model("fog"))}, request_of());
  expect_no_worse({testing::write_ply(folder_ / "needles.ply", reference::make_gaussian_model("needles"))},
                  request_of());
}

TEST_F(MixedMotionGL, OverAMediumWithAnEllipsoidInIt) {
  expect_no_worse({cube()}, faint());
  expect_no_worse({cube(), glyph(0.2)}, faint());
}

TEST_F(MixedMotionGL, OverTransparentSurfaces) {
  expect_no_worse({plane(0.5), plane(-0.7)}, faint());
}

TEST_F(MixedMotionGL, OverAllTogether) {
  expect_no_worse({splat(), cube(), plane(0.6), glyph(-0.7)}, faint());
}

}  // namespace
}  // namespace surfcast::gaussian
