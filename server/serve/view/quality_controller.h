#pragma once

#include <array>
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
  std::array<double, 8> recent{};  ///< milliseconds of the last frames of this rung, newest first
  int frames = 0;                  ///< frames of this rung
  int frames_before_climb = 8;     ///< value of `frames` from which on a better rung may be tried
  int since_climb = 0;             ///< frames since a better rung was last tried
  size_t climbed_from = 0;         ///< the rung before that
};

/// Drawing and the link are adapted independently. The smaller of the two scales is used.
struct QualityState {
  LadderState draw;
  LadderState link;
};

/// The initial state, before any measurement.
QualityState first_quality();

/// The next state after a frame that was drawn with the given state. Drawing, encoding, transfer and display of
/// successive frames overlap, so each of them separately must fit in the frame time of `target_fps`.
///
/// A rate of frames is an average, and the times of single frames vary by a factor of two and more: the quality follows
/// the mean of the last eight frames without the slowest of them. Only two frames in a row that take far too long lower
/// it at once, to the best rung that fits the faster of the two. After a raise that turned out too expensive, the next
/// one waits for twice as many frames.
QualityState adapt(const QualityState& state, const MotionCost& cost, double target_fps);

/// Likewise after a frame of a video, whose size is chosen otherwise: the link's ladder stays as it is.
QualityState adapt_drawing(const QualityState& state, const MotionCost& cost, double target_fps);

MotionQuality quality_of(const QualityState& state);
/// Of a frame of a video: without what only the link demands of files.
MotionQuality drawing_of(const QualityState& state);

}  // namespace surfcast::view
