#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

/// A camera and the time at which it applies.
struct Keyframe {
  double time = 0;  ///< seconds
  wire::Camera camera;
};

/// An animated camera, interpolated between keyframes.
///
/// Position, focal point and view angle are cubic Hermite splines through the keyframes. The velocity at an inner
/// keyframe is the slope of the parabola through this keyframe and its two neighbours (Catmull-Rom for uneven times).
/// The velocity at both ends is zero. The camera rests between two identical keyframes. The speed at a keyframe is at
/// most three times the lower of the mean speeds of the two adjacent segments, which limits overshoot where times are
/// uneven. view_up turns at a constant rate between two keyframes and is kept perpendicular to the view direction.
class CameraPath {
 public:
  /// Parses {"keyframes": [{"time": s, "position": [x,y,z], "focal_point": [x,y,z], "view_up": [x,y,z],
  /// "view_angle": degrees}, ...]}. view_up and view_angle are optional, but each must be in all keyframes or in none.
  /// Also parses saved views, as the viewer exports them and as they are kept beside a model: {"views": [{"name": "",
  /// "parameters": {"position": "x,y,z", ...}}, ...]}. Then the camera passes through the views in their order, one
  /// every `seconds_per_view`. The view angle of a view that has none is 30 degrees, as in a link.
  static Result<CameraPath> parse(std::string_view json, double seconds_per_view = kSecondsPerView);
  static Result<CameraPath> read(const std::string& file, double seconds_per_view = kSecondsPerView);

  /// Number of frames at `per_second`. The first frame shows the first keyframe; the last frame shows the last keyframe
  /// if the duration is a whole number of frames. kLimit when there are more than kMaxFrames.
  [[nodiscard]] Result<int> frames(double per_second) const;
  [[nodiscard]] wire::Camera camera_at(double time) const;
  /// The camera of frame `number`; the first frame is 0.
  [[nodiscard]] wire::Camera camera_of(int number, double per_second) const;

  static constexpr int kMaxFrames = 1'000'000;
  static constexpr double kSecondsPerView = 4;

 private:
  explicit CameraPath(std::vector<Keyframe> keyframes) : keyframes_(std::move(keyframes)) {}

  std::vector<Keyframe> keyframes_;  ///< at least two, times ascending
};

/// The file name of frame `number`. "%d" or "%05d" in the pattern stands for the number, "%%" for a percent sign. An
/// error unless the pattern contains exactly one number.
Result<std::string> frame_name(std::string_view pattern, int number);

}  // namespace surfcast::protocol
