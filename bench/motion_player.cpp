#include "motion_player.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>

#include "bench_support.h"

namespace surfcast::bench {
namespace {

using geometry::Camera;
using Clock = client::View::Clock;

constexpr double kUpdateEvery = 0.016;  // seconds

wire::Camera to_message(const Camera& camera) {
  const auto set = [](const glm::dvec3& from, wire::Vector3& to) {
    to.set_x(from.x);
    to.set_y(from.y);
    to.set_z(from.z);
  };
  wire::Camera message;
  set(camera.position, *message.mutable_position());
  set(camera.focal_point, *message.mutable_focal_point());
  set(camera.view_up, *message.mutable_view_up());
  message.set_view_angle(camera.view_angle);
  return message;
}

Camera from_message(const wire::Camera& camera) {
  const auto vector = [](const wire::Vector3& v) { return glm::dvec3(v.x(), v.y(), v.z()); };
  return {vector(camera.position()), vector(camera.focal_point()), vector(camera.view_up()), camera.view_angle()};
}

wire::DrawPicture request_of(const std::string& model, const Camera& camera) {
  wire::DrawPicture picture;
  picture.set_model(model);
  picture.mutable_resolution()->set_width(kWidth);
  picture.mutable_resolution()->set_height(kHeight);
  picture.set_spacing(1);
  *picture.mutable_camera() = to_message(camera);
  return picture;
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Arrived arrived_after(Clock::time_point start, client::View::Frame frame) {
  const double seconds = std::chrono::duration<double>(frame.arrived - start).count();
  return {seconds, std::move(frame.frame), frame.bytes, frame.whole};
}

}  // namespace

std::vector<Arrived> play(const Player& player, const Path& path, double seconds,
                          const std::function<void(double)>& tick, double rest) {
  client::ServerConnection connection =
      value_or_exit(client::ServerConnection::open({.host = "127.0.0.1", .port = player.port}, {}));
  client::View view =
      value_or_exit(client::View::open(connection, request_of(player.model, player.begin), player.wishes));
  std::vector<Arrived> frames(1);
  while (!frames.front().frame.picture().converged()) {
    auto frame = value_or_exit(view.next_until(Clock::now() + std::chrono::seconds(60)));
    if (!frame || !view.painted(*frame)) std::exit(1);
    frames.front().frame = frame->frame;
  }
  const Clock::time_point start = Clock::now();
  for (double next = 0; seconds_since(start) < seconds;) {
    const double now = seconds_since(start);
    tick(now);
    if (now >= next) {
      value_or_exit(view.show(request_of(player.model, path.at(player.begin, now)), /*moving=*/true));
      next = std::max(next + kUpdateEvery, now);
    }
    const auto until = start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(next));
    const auto frame = value_or_exit(view.next_until(until));
    if (!frame) continue;
    if (!view.painted(*frame)) std::exit(1);
    frames.push_back(arrived_after(start, *frame));
  }
  if (rest <= 0) return frames;
  value_or_exit(view.show(request_of(player.model, path.at(player.begin, seconds)), /*moving=*/false));
  const auto end = start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds + rest));
  while (const auto frame = value_or_exit(view.next_until(end))) {
    if (!view.painted(*frame)) std::exit(1);
    frames.push_back(arrived_after(start, *frame));
  }
  return frames;
}

/// With cells of twice the size, each with its nearest surface.
warp::DepthPlane coarser(const warp::DepthPlane& plane) {
  warp::DepthPlane coarse{(plane.width + 1) / 2, (plane.height + 1) / 2, 2 * plane.cell, {}, plane.seen_through};
  coarse.inverse.resize(static_cast<size_t>(coarse.width) * coarse.height);
  for (int row = 0; row < plane.height; ++row) {
    for (int column = 0; column < plane.width; ++column) {
      float& nearest = coarse.inverse[static_cast<size_t>(row / 2) * coarse.width + column / 2];
      nearest = std::max(nearest, plane.inverse[static_cast<size_t>(row) * plane.width + column]);
    }
  }
  return coarse;
}

warp::WarpFrame decoded(const wire::ViewFrame& frame, window::VideoDecoder& video, bool coarse) {
  window::PixelImage image = value_or_exit(window::decode_frame(frame, video));
  for (size_t i = 0; i < image.pixels.size(); i += 4) std::swap(image.pixels[i], image.pixels[i + 2]);
  const Camera camera = from_message(frame.picture().camera());
  const auto seen_by = value_or_exit(geometry::make_camera_frame(camera, image.width, image.height));
  warp::Pixels pixels{image.width, image.height, std::move(image.pixels)};
  if (!frame.has_depth()) return {std::move(pixels), seen_by, {}, {}, false};
  const warp::DepthPlane depth = value_or_exit(warp::decode_depth(frame.depth(), image.width, image.height));
  return warp::make_warp_frame(std::move(pixels), seen_by, coarse ? coarser(depth) : depth);
}

}  // namespace surfcast::bench
