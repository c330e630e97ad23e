#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

/// A camera at a time.
struct Keyframe {
  double time = 0;  ///< seconds
  wire::Camera camera;
};

/// A flight of a camera through keyframes.
///
/// Position, focal point and view angle pass through the keyframes on cubics whose velocity at a keyframe is that of a
/// parabola through it and its neighbours (Catmull-Rom splines for uneven times), and zero at both ends. Where two
/// keyframes in a row are alike the camera rests between them. No velocity is more than three times the slower of the
/// mean velocities before and after, so that nothing overshoots far where times are uneven. The direction that is up
/// turns evenly and is kept perpendicular to the view.
class CameraPath {
 public:
  /// From {"keyframes": [{"time": s, "position": [x,y,z], "focal_point": [x,y,z], "view_up": [x,y,z],
  /// "view_angle": degrees}, ...]}; view_up and view_angle may be left out of all of them.
  static Result<CameraPath> parse(std::string_view json);
  static Result<CameraPath> read(const std::string& file);

  /// Frames at so many per second, the first keyframe and the last one included; at most kMaxFrames.
  [[nodiscard]] Result<int> frames(double per_second) const;
  [[nodiscard]] wire::Camera camera_at(double time) const;
  /// Of frame `number`, from 0.
  [[nodiscard]] wire::Camera camera_of(int number, double per_second) const;

  static constexpr int kMaxFrames = 1'000'000;

 private:
  explicit CameraPath(std::vector<Keyframe> keyframes) : keyframes_(std::move(keyframes)) {}

  std::vector<Keyframe> keyframes_;  ///< at least two, times ascending
};

/// The name of a frame's file: "%d" or "%05d" in the pattern becomes its number; "%%" a percent sign. An error unless
/// there is just one number.
Result<std::string> frame_name(std::string_view pattern, int number);

}  // namespace surfcast::protocol
