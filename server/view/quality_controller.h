#pragma once

#include <cstddef>

namespace surfcast::view {

/// How a motion frame is drawn and encoded.
struct MotionQuality {
  double scale = 1;       ///< factor on width and height
  double spacing = 1;     ///< projected spacing at which refinement stops, pixels of the scaled picture
  int jpeg_quality = 80;  ///< 1 to 100
};

/// Time spent on the last motion frame, milliseconds.
struct MotionCost {
  double draw = 0;  ///< waiting for the render thread, and drawing
  double encode = 0;
  double transfer = 0;  ///< time that the frame occupied the link
  double client = 0;    ///< from arrival to display
};

/// The position on a ladder of settings, from the best (rung 0) to the cheapest, and the evidence for leaving it.
struct LadderState {
  size_t rung = 0;
  int slow = 0;         ///< consecutive frames over the time budget
  int fast = 0;         ///< consecutive frames that leave room for a better rung
  double least_ms = 0;  ///< the least time of the frames counted in `slow`, or the greatest of those counted in `fast`
  int frames_before_climb = 6;  ///< value of `fast` at which a better rung is tried
  int since_climb = 0;          ///< frames since a better rung was last tried
};

/// Drawing and the link are adapted independently. The smaller of the two scales is used.
struct QualityState {
  LadderState draw;
  LadderState link;
};

/// The initial state, before any measurement.
QualityState first_quality();

/// The next state after a frame that was drawn with the given state. Drawing, encoding, transfer and display of
/// successive frames overlap, so each of them separately must fit in the frame time of `target_fps`. One slow frame
/// changes nothing. Two in a row lower the quality to the best rung that fits the faster of the two. Raising it takes
/// several frames that leave room, and twice as many each time that a raise turned out too expensive.
QualityState adapt(const QualityState& state, const MotionCost& cost, double target_fps);

MotionQuality quality_of(const QualityState& state);

}  // namespace surfcast::view
