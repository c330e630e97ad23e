#pragma once

#include <map>
#include <string>
#include <vector>

#include "client/bench_run.h"

namespace surfcast::client {

/// Summary of a sample. Percentiles are by nearest rank, so each is one of the values.
struct Percentiles {
  size_t count = 0;
  double mean = 0;
  double p50 = 0;
  double p95 = 0;
  double p99 = 0;
  double most = 0;
};

Percentiles percentiles(std::vector<double> values);

/// The results of a run, over all clients that read their frames.
struct BenchReport {
  size_t clients = 0;
  Percentiles frames_per_second;  ///< while moving, over clients
  Percentiles latency;            ///< of moving frames: milliseconds from sending a camera to receiving its frame
  Percentiles latency_begin;      ///< in the first third of each client's run
  Percentiles latency_end;        ///< in the last third
  std::map<std::string, Percentiles> moving_stages;  ///< milliseconds of each stage, as reported by the server
  Percentiles turned;          ///< degrees between a moving frame and the client's camera when it arrives
  Percentiles depth_bytes;     ///< of a moving frame
  Percentiles outside;         ///< latency not covered by any stage: network, waiting for it, and the client
  Percentiles moving_bytes;    ///< of a frame
  Percentiles moving_width;    ///< pixels
  Percentiles moving_spacing;  ///< pixels
  Percentiles converged;       ///< milliseconds from the end of a movement to the converged frame
  std::map<std::string, Percentiles> rest_stages;  ///< of the converged frame, as moving_stages
  Percentiles rest_bytes;                          ///< of a converged frame
  uint64_t updates = 0;
  uint64_t moving_frames = 0;
  uint64_t video_frames = 0;  ///< of these: packets of a video
  uint64_t abandoned = 0;
  uint64_t unconverged = 0;
  uint64_t late = 0;
  uint64_t bytes = 0;
};

BenchReport make_report(const std::vector<BenchRecord>& records);

/// A short table for display.
std::string to_text(const BenchReport& report);
/// All results as JSON.
std::string to_json(const BenchReport& report, const std::string& url);

}  // namespace surfcast::client
