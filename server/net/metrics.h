#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "picture/device_info.h"
#include "picture/picture.h"
#include "view/view_session.h"

namespace surfcast::net {

/// What the server counts while it runs. Lives on the thread of the sockets.
struct Metrics {
  uint64_t connections = 0;          ///< accepted since the start
  uint64_t connections_refused = 0;  ///< too many at once, of all clients or of one
  uint64_t requests = 0;             ///< messages and HTTP requests
  uint64_t errors = 0;               ///< requests answered with an error
  uint64_t pictures = 0;             ///< delivered to a session
  uint64_t picture_bytes = 0;        ///< encoded
  uint64_t surfels_drawn = 0;
  view::ViewCounts views;
  std::map<std::string, double> stage_seconds;  ///< by the name of the stage, summed over pictures and frames of views

  void count_picture(size_t bytes, const picture::FrameStats& stats);
  void count_stages(const picture::FrameStats& stats);
};

/// What there is at the moment.
struct Gauges {
  size_t connections = 0;         ///< open
  size_t queued = 0;              ///< pictures that wait for the render thread
  picture::MemoryBudgets memory;  ///< of the renderer
};

/// The text that Prometheus reads.
std::string to_prometheus(const Metrics& metrics, const Gauges& gauges);

}  // namespace surfcast::net
