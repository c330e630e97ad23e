#include "client/window/warped_view.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "client/navigation.h"
#include "geometry/camera.h"

namespace surfcast::window {
namespace {

Result<geometry::CameraFrame> frame_of(const wire::Camera& camera, int width, int height) {
  return geometry::make_camera_frame({client::vector_of(camera.position()), client::vector_of(camera.focal_point()),
                                      client::vector_of(camera.view_up()), camera.view_angle()},
                                     width, height);
}

/// Whether two cameras show the same, but for rounding: the server states the camera of a first picture with another
/// view up.
bool same_view(const geometry::CameraFrame& a, const geometry::CameraFrame& b) {
  constexpr double kSameTurn = 1e-6;  // radians; below any pixel
  return a.eye == b.eye && glm::distance(a.up, b.up) < kSameTurn && glm::distance(a.forward, b.forward) < kSameTurn &&
         std::abs(a.eta / a.height - b.eta / b.height) < kSameTurn;
}

std::shared_ptr<const warp::WarpFrame> warp_frame(const wire::ViewFrame& frame, const PixelImage& image) {
  if (!frame.has_depth()) return nullptr;
  const Result<warp::DepthPlane> depth = warp::decode_depth(frame.depth(), image.width, image.height);
  const Result<geometry::CameraFrame> camera = frame_of(frame.picture().camera(), image.width, image.height);
  if (!depth || !camera) return nullptr;
  return std::make_shared<const warp::WarpFrame>(
      warp::make_warp_frame({image.width, image.height, image.pixels}, *camera, *depth));
}

}  // namespace

WarpedView::WarpedView(const wire::Color& background)
    : background_{static_cast<uint8_t>(background.blue()), static_cast<uint8_t>(background.green()),
                  static_cast<uint8_t>(background.red()), 255} {}

void WarpedView::take(const wire::ViewFrame& frame, PixelImage pixels) {
  newest_ = std::move(pixels);
  moving_ = frame.moving();
  warp_ = warp_frame(frame, newest_);
  if (!moving_) rest_ = warp_;
}

std::optional<PixelImage> WarpedView::seen_by(const wire::Camera& camera, int width, int height) const {
  const Result<geometry::CameraFrame> target = frame_of(camera, width, height);
  if (!warp_ || !target || same_view(warp_->camera, *target)) return std::nullopt;
  warp::Pixels pixels = warp::warp(*warp_, moving_ ? rest_.get() : nullptr, *target, background_);
  return PixelImage{pixels.width, pixels.height, std::move(pixels.bytes)};
}

}  // namespace surfcast::window
