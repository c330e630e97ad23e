#pragma once

namespace surfcast::service {

/// Divides the render thread's time between motion pictures and still pictures. Motion pictures take precedence, also
/// between two batches of a still picture, unless the still pictures have received less than their share: a quarter of
/// the time while any of them waits. So motion is delayed by a few milliseconds. A still picture that competes with
/// permanent motion takes four times as long as alone, plus a delay that does not depend on its length.
class DrawShares {
 public:
  /// A motion picture was drawn in this time. `others_wait`: a still picture waits or is unfinished.
  void drew_motion(double milliseconds, bool others_wait);
  /// A still picture, or a part of one, was drawn in this time.
  void drew_other(double milliseconds);

  [[nodiscard]] bool motion_first() const { return owed_ms_ <= 0; }

 private:
  double owed_ms_ = 0;  ///< time that still pictures lack of their share; negative: they had more
};

}  // namespace surfcast::service
