#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "client/server_connection.h"

namespace surfcast::client {

/// The behaviour of a benchmark client: it alternates between moving the camera around the model and resting.
struct BenchPlan {
  protocol::Endpoint server;
  wire::DrawPicture picture;       ///< its camera, if any, is the start of the path
  double target_fps = 0;           ///< as in OpenView
  bool depth = false;              ///< as in OpenView
  bool video = false;              ///< asks for a video in VP9
  double seconds = 20;             ///< of the whole run
  double move_seconds = 4;         ///< of one movement
  double rest_seconds = 5;         ///< longest rest; it ends 0.5 s after the converged picture
  double updates_per_second = 60;  ///< while moving: the refresh rate of a screen
  bool reads = true;               ///< false: reads the first picture only
};

/// A frame received by a client.
struct BenchFrame {
  bool moving = false;     ///< drawn while the camera moved
  bool converged = false;  ///< no better picture follows
  double latency_ms = 0;   ///< from sending the newest camera that it shows, or from the end of the movement
  double turned = 0;       ///< degrees between its view direction and that of the client when it arrived
  uint64_t depth_bytes = 0;
  bool video = false;                                  ///< a packet of the video
  uint64_t bytes = 0;                                  ///< on the wire
  uint32_t width = 0;                                  ///< of the picture, pixels
  double spacing = 0;                                  ///< projected surfel spacing of the picture, pixels
  std::vector<std::pair<std::string, double>> stages;  ///< milliseconds, as reported by the server
};

/// The frames and counters of one client.
struct BenchRecord {
  std::vector<BenchFrame> frames;
  double moving_seconds = 0;
  uint64_t updates = 0;      ///< cameras sent while moving
  uint64_t abandoned = 0;    ///< frames that were received incompletely
  uint64_t unconverged = 0;  ///< rests that ended without a converged frame
  uint64_t late = 0;         ///< frames received after the converged one
  uint64_t bytes = 0;        ///< received in total
};

/// Runs the plan. `phase` is the start on the path, as a share of one turn around the model; different values make
/// parallel clients request different pictures.
Result<BenchRecord> run_bench_client(const BenchPlan& plan, const ClientConfig& config, double phase);

}  // namespace surfcast::client
