#pragma once

#include <chrono>
#include <deque>

#include "geometry/camera.h"
#include "view/view_plan.h"

namespace surfcast::view {

/// The camera that follows when the motion from `before` to `now` goes on for `steps` times as long again: along the
/// screw motion between the two (a rotation about an axis, and a translation along it), which is exact for orbits,
/// turns and translations. `now` itself where the two are no motion: too far apart, or not valid.
geometry::Camera continue_motion(const geometry::Camera& before, const geometry::Camera& now, double steps);

/// Predicts the camera of a client that moves, from the cameras that have arrived.
class CameraForecast {
 public:
  /// Motion is measured over the cameras of this time: single steps of a pointer are uneven.
  static constexpr std::chrono::milliseconds kWindow{100};
  /// Two cameras that were held up on the way arrive at once. Motion is therefore no faster than over this time.
  static constexpr std::chrono::milliseconds kMinElapsed{33};
  /// Later cameras than this are not predicted.
  static constexpr std::chrono::milliseconds kFarthest{300};
  /// After so long without another camera the motion has ended.
  static constexpr std::chrono::milliseconds kPause{80};

  void record(const geometry::Camera& camera, ViewTime arrived);
  void clear() { past_.clear(); }
  /// The camera that would arrive at `when`, seen from `now`. There must be a camera.
  [[nodiscard]] geometry::Camera at(ViewTime when, ViewTime now) const;

 private:
  struct Arrived {
    geometry::Camera camera;
    ViewTime at;
  };
  std::deque<Arrived> past_;  ///< oldest first
};

}  // namespace surfcast::view
