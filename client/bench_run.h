#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "client/server_connection.h"

namespace surfcast::client {

/// What a client of the benchmark does: it moves the camera around the model as a hand would, rests, and so on.
struct BenchPlan {
  protocol::Endpoint server;
  wire::DrawPicture picture;       ///< its camera, if any, is where the path begins
  double target_fps = 0;           ///< as in OpenView
  double seconds = 20;             ///< of the whole run
  double move_seconds = 4;         ///< of one movement
  double rest_seconds = 5;         ///< most that a rest takes; it ends when the picture has converged
  double updates_per_second = 60;  ///< while moving: those of a screen
  bool reads = true;               ///< false: reads the first picture and nothing more
};

/// A frame as a client saw it.
struct BenchFrame {
  bool moving = false;     ///< shows a camera that was moving
  bool converged = false;  ///< nothing better was to come
  double latency_ms = 0;   ///< from sending the newest camera that it shows, or from the end of the movement
  uint64_t bytes = 0;      ///< on the wire
  uint32_t width = 0;      ///< of the picture, pixels
  double spacing = 0;      ///< that it was drawn with, pixels
  std::vector<std::pair<std::string, double>> stages;  ///< milliseconds, as the server states them
};

/// What one client went through.
struct BenchRecord {
  std::vector<BenchFrame> frames;
  double moving_seconds = 0;
  uint64_t updates = 0;      ///< cameras that were sent while moving
  uint64_t abandoned = 0;    ///< frames whose rest never came
  uint64_t unconverged = 0;  ///< rests that ended without a converged frame
  uint64_t late = 0;         ///< frames that came after the converged one
  uint64_t bytes = 0;        ///< received in all
};

/// Plays the plan to its end; `phase` from 0 to 1 is where on its path the client begins, so that several do not ask
/// for the same pictures.
Result<BenchRecord> run_bench_client(const BenchPlan& plan, const ClientConfig& config, double phase);

}  // namespace surfcast::client
