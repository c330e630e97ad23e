#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "camera_paths.h"
#include "client/view.h"
#include "client/window/video_decoder.h"
#include "warp/warp.h"

namespace surfcast::bench {

// Of the views that are played.
inline constexpr int kWidth = 1280;
inline constexpr int kHeight = 720;

/// A frame that has arrived.
struct Arrived {
  double seconds = 0;  ///< since the movement began
  wire::ViewFrame frame;
  uint64_t bytes = 0;
  bool whole = true;
};

/// A client, and what it plays.
struct Player {
  uint16_t port = 0;
  std::string model;
  Camera begin;
  client::ViewWishes wishes;
};

/// The frames of a movement, and before them the one at rest from which it begins; then those of a rest of so many
/// seconds. `tick` gets the seconds since. Ends the program where the server fails.
std::vector<Arrived> play(const Player& player, const Path& path, double seconds,
                          const std::function<void(double)>& tick, double rest = 0);

/// A frame as a client has it. `video` has decoded the packets before it. `coarse`: cells of depth have twice the size.
warp::WarpFrame decoded(const wire::ViewFrame& frame, window::VideoDecoder& video, bool coarse = false);

}  // namespace surfcast::bench
