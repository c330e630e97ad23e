#pragma once

#include <cstddef>

namespace surfcast::view {

/// How a frame for motion is drawn and encoded.
struct MotionQuality {
  double scale = 1;       ///< of width and height
  double spacing = 1;     ///< projected spacing of surfels to stop at, pixels of the smaller picture
  int jpeg_quality = 80;  ///< 1 to 100
};

/// What the last frame for motion took, milliseconds.
struct MotionCost {
  double draw = 0;  ///< waiting for the render thread and being drawn
  double encode = 0;
  double transfer = 0;  ///< that the frame kept the line busy
  double client = 0;    ///< from its arrival to its being painted
};

/// A place on a ladder of settings, from the best (0) to the cheapest, and how often it was too expensive or cheaper
/// than it need be.
struct LadderState {
  size_t rung = 0;
  int slow = 0;                 ///< frames in a row that took too long
  int fast = 0;                 ///< frames in a row after which a better rung could be afforded
  double least_ms = 0;          ///< of the frames counted in `slow` or the most of those in `fast`
  int frames_before_climb = 6;  ///< frames in `fast` before a better rung is tried
  int since_climb = 0;          ///< frames since a better rung was tried
};

/// Drawing and the line are adapted each by itself; the smaller of the two scales is drawn.
struct QualityState {
  LadderState draw;
  LadderState link;
};

/// Where a view begins, before anything has been measured.
QualityState first_quality();

/// The next state after a frame that was drawn as the state says. What goes on at a time (drawing, encoding, transfer,
/// painting of successive frames) must each fit in the time of a frame at `target_fps`. One frame that took long
/// changes nothing; two in a row lower the quality to what they would have afforded; to raise it takes several that
/// leave room, and more of them each time that raising it turned out too much.
QualityState adapt(const QualityState& state, const MotionCost& cost, double target_fps);

MotionQuality quality_of(const QualityState& state);

}  // namespace surfcast::view
