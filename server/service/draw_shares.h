#pragma once

namespace surfcast::service {

/// Shares the render thread's time between pictures of motions and all others. A motion's picture goes first, also
/// between two batches of another one, until the others are owed: they have a quarter of the time as long as they wait.
/// So whoever moves is delayed by a few milliseconds, and a picture at rest beside somebody who never stops takes
/// four times as long as alone, and some more that does not depend on its length.
class DrawShares {
 public:
  /// A picture of a motion was drawn in that time; `others_wait`: one that is not waited for its end.
  void drew_motion(double milliseconds, bool others_wait);
  /// Another picture, or a part of one, was drawn in that time.
  void drew_other(double milliseconds);

  [[nodiscard]] bool motion_first() const { return owed_ms_ <= 0; }

 private:
  double owed_ms_ = 0;  ///< to pictures that are of no motion; negative: they had more than their share
};

}  // namespace surfcast::service
