#pragma once

namespace surfcast::service {

/// The still pictures that wait or are unfinished.
enum class WaitingStills { kNone, kLarge, kSmall };  ///< kSmall: a small one is among them

/// Divides the render thread's time between motion pictures and still pictures. Motion pictures take precedence, also
/// between two batches of a still picture, unless the still pictures have received less than their share of the time
/// while any of them waits: half of it for small ones, a quarter for large ones. So motion is delayed by a few
/// milliseconds. A still picture that competes with permanent motion takes twice or four times as long as alone, plus a
/// delay that does not depend on its length.
class DrawShares {
 public:
  /// A motion picture was drawn in this time, while these waited.
  void drew_motion(double milliseconds, WaitingStills stills);
  /// A still picture, or a part of one, was drawn in this time.
  void drew_other(double milliseconds);

  [[nodiscard]] bool motion_first() const { return owed_ms_ <= 0; }

 private:
  double owed_ms_ = 0;  ///< time that still pictures lack of their share; negative: they had more
};

}  // namespace surfcast::service
