#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "net/exposition.h"
#include "picture/device_info.h"
#include "picture/picture.h"
#include "view/view_session.h"

namespace surfcast::net {

/// How long pictures of one kind take.
struct PictureTimes {
  Histogram queue;  ///< until they are drawn
  Histogram whole;  ///< all stages together
};

/// What the server counts while it runs. Lives on the thread of the sockets.
struct Metrics {
  uint64_t connections = 0;          ///< accepted since the start
  uint64_t connections_refused = 0;  ///< too many at once, of all clients or of one
  uint64_t connections_given_way = 0;
  uint64_t tls_failures = 0;        ///< handshakes that failed
  uint64_t tls_reloads_failed = 0;  ///< new certificates that could not be used; the former ones stay
  double tls_expires = 0;           ///< end of the certificate, seconds since 1970; 0: no TLS
  uint64_t requests = 0;            ///< messages and HTTP requests
  uint64_t errors = 0;              ///< requests answered with an error
  uint64_t pictures = 0;            ///< delivered to a session
  uint64_t picture_bytes = 0;       ///< encoded
  uint64_t surfels_drawn = 0;
  view::ViewCounts views;
  PictureTimes still;                           ///< pictures that are asked for one by one
  PictureTimes view;                            ///< frames of views
  std::map<std::string, double> stage_seconds;  ///< by the name of the stage, summed over pictures and frames of views

  void count_picture(size_t bytes, const picture::FrameStats& stats);
  void count_stages(const picture::FrameStats& stats, PictureTimes& times);
};

/// Processes of one purpose, since the start.
struct ProcessGauges {
  uint64_t started = 0;
  uint64_t ended = 0;        ///< crashed, killed or hung
  uint64_t quarantined = 0;  ///< blocks that are not loaded any more, because they have ended two of them
};

struct WorkerGauges {
  ProcessGauges render;   ///< processes that draw
  ProcessGauges queries;  ///< processes that answer picks, profiles and the like
};

/// What there is at the moment.
struct Gauges {
  size_t connections = 0;                 ///< open
  size_t waiting = 0;                     ///< sessions without a connection
  uint64_t audit_lost = 0;                ///< events, since the start
  uint64_t audit_left_out = 0;            ///< denials, since the start
  size_t queued = 0;                      ///< pictures that wait for the render thread
  size_t picture_memory = 0;              ///< bytes of pictures at rest that are drawn, encoded or not taken yet
  size_t users = 0;                       ///< connections with a token
  uint64_t denied = 0;                    ///< wrong tokens since the start
  picture::MemoryBudgets memory;          ///< of the renderer
  std::optional<WorkerGauges> workers{};  ///< none: the server draws itself
};

/// The text that Prometheus reads.
std::string metrics_text(const Metrics& metrics, const Gauges& gauges, Exposition::Format format);

}  // namespace surfcast::net
