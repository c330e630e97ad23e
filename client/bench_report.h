#pragma once

#include <map>
#include <string>
#include <vector>

#include "client/bench_run.h"

namespace surfcast::client {

/// What is left of many values. Nearest rank: a value that occurred.
struct Percentiles {
  size_t count = 0;
  double mean = 0;
  double p50 = 0;
  double p95 = 0;
  double p99 = 0;
  double most = 0;
};

Percentiles percentiles(std::vector<double> values);

/// The figures of a run, over all clients that read.
struct BenchReport {
  size_t clients = 0;
  Percentiles frames_per_second;  ///< while moving, over clients
  Percentiles latency;            ///< of frames in motion, milliseconds from sending a camera to having its frame
  Percentiles latency_begin;      ///< in the first third of each client's run
  Percentiles latency_end;        ///< in the last third
  std::map<std::string, Percentiles> moving_stages;  ///< milliseconds, as the server states them
  Percentiles outside;         ///< latency that no stage accounts for: the way, waiting for it, and the client
  Percentiles moving_bytes;    ///< of a frame
  Percentiles moving_width;    ///< pixels
  Percentiles moving_spacing;  ///< pixels
  Percentiles converged;       ///< milliseconds from the end of a movement to the final frame
  Percentiles rest_bytes;      ///< of a final frame
  uint64_t updates = 0;
  uint64_t moving_frames = 0;
  uint64_t abandoned = 0;
  uint64_t unconverged = 0;
  uint64_t late = 0;
  uint64_t bytes = 0;
};

BenchReport make_report(const std::vector<BenchRecord>& records);

/// A short table for a person.
std::string to_text(const BenchReport& report);
/// The same and more for a program.
std::string to_json(const BenchReport& report, const std::string& url);

}  // namespace surfcast::client
