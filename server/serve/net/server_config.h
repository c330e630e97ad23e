#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "net/annotations.h"
#include "net/clients.h"
#include "net/kept_sessions.h"
#include "net/metrics.h"
#include "net/proxy_header.h"
#include "net/request_window.h"
#include "net/static_files.h"
#include "net/uploads.h"
#include "tls/certificate_files.h"
#include "view/view_session.h"

namespace surfcast::net {

struct ServerConfig {
  std::string host = "127.0.0.1";
  uint16_t port = 7600;          ///< 0: any free one
  tls::CertificateFiles tls;     ///< with a certificate, connections may begin with TLS; others may not, see admit
  std::filesystem::path tokens;  ///< the file of those who may ask for models, see Gatekeeper; empty: everybody
  std::filesystem::path audit;   ///< file that tells who asked for what, see AuditLog; empty: none
  size_t log_lines = 60;         ///< of one kind a minute, of kinds that clients cause; 0: all
  ClientLimits clients;
  RequestWindow::Limits requests;                           ///< of one connection of the framed protocol
  size_t views = 8;                                         ///< open at a time on one connection
  double target_fps = 30;                                   ///< of views in motion whose client does not say
  size_t unread_bytes = size_t{64} << 20;                   ///< of answers; beyond it the connection is not read from
  size_t small_unread_bytes = size_t{1} << 20;              ///< the same of small answers, with their overhead
  size_t kept_frame_bytes = view::ViewOptions::kKeptBytes;  ///< see ViewOptions
  size_t request_bytes = size_t{64} << 10;    ///< of one message of a client; ours send no more than kMaxRequestBytes
  uint32_t http_header_bytes = 16384;         ///< of one request of HTTP
  std::chrono::milliseconds hello{10'000};    ///< for the first words of a connection, and for any request that begins
  std::chrono::milliseconds idle{300'000};    ///< without a whole request and with nothing outstanding
  std::chrono::milliseconds give_way{1'000};  ///< idle for so long, a connection gives way to one beyond the limit
  std::chrono::milliseconds stall{30'000};    ///< without any byte of an answer being taken
  size_t least_rate = size_t{8} << 10;     ///< bytes of answers that a client takes each second, over `stall`; 0: none
  std::chrono::milliseconds ping{30'000};  ///< without a word on a WebSocket, before the client is asked for one
  KeptSessions::Limits sessions;           ///< whose clients may come back
  std::chrono::milliseconds grace{0};      ///< for others to see that the server stops, before it does
  std::chrono::milliseconds leave{0};      ///< then, over which clients with views are sent away one after the other
  std::chrono::milliseconds drain{5'000};  ///< then, for what is outstanding
  std::shared_ptr<const StaticFiles> viewer;  ///< served at "/"; null: a hint where to get one
  std::function<WorkerGauges()> workers;      ///< of its processes; empty: there are none
  UploadConfig uploads;                       ///< scans that clients may send
  AnnotationConfig annotations;               ///< saved views and annotations of models
  Networks trusted_proxies;                   ///< which tell whose words they pass on
  std::vector<std::string> hosts;             ///< names of the server beside `host`, see GuardConfig
  std::vector<std::string> allowed_origins;   ///< of pages that may open a WebSocket beside the viewer's own
};

}  // namespace surfcast::net
