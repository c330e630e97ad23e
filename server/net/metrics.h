#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "picture/picture.h"
#include "view/view_session.h"

namespace surfcast::net {

/// What the server counts while it runs. Lives on the thread of the sockets.
struct Metrics {
  uint64_t connections = 0;          ///< accepted since the start
  uint64_t connections_open = 0;     ///< now
  uint64_t connections_refused = 0;  ///< too many at once
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

/// The text that Prometheus reads. `queued` is the number of pictures that wait now.
std::string to_prometheus(const Metrics& metrics, size_t queued);

}  // namespace surfcast::net
