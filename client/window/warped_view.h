#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "client/window/decode_picture.h"
#include "surfcast.pb.h"
#include "warp/warp.h"

namespace surfcast::window {

/// What is shown while newer frames are on their way: the newest frame, and under it the last one at rest, as the
/// present camera sees them.
class WarpedView {
 public:
  /// `background`: the colour of frames where they show nothing.
  explicit WarpedView(const wire::Color& background);
  /// Takes the newest frame and its pixels. A frame whose depth is damaged counts as one without.
  void take(const wire::ViewFrame& frame, PixelImage pixels);
  /// The view of a camera, `width` x `height` pixels. Nothing where the newest frame is to be shown as it is: it has
  /// this camera, or no depth, or none has arrived.
  [[nodiscard]] std::optional<PixelImage> seen_by(const wire::Camera& camera, int width, int height) const;
  /// The newest frame as it is.
  [[nodiscard]] const PixelImage& newest() const { return newest_; }

 private:
  std::array<uint8_t, 4> background_;  ///< as a pixel of PixelImage
  PixelImage newest_;
  std::shared_ptr<const warp::WarpFrame> warp_;  ///< the newest frame, if it has a depth
  std::shared_ptr<const warp::WarpFrame> rest_;  ///< the last one at rest
  bool moving_ = false;
};

}  // namespace surfcast::window
