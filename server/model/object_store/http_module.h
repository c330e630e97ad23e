#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/byte_source.h"

namespace surfcast::object_store {

/// How requests are signed by AWS Signature Version 4.
struct Signing {
  std::string scheme;  ///< as CURLOPT_AWS_SIGV4 wants it: "aws:amz:REGION:s3"
  std::string key;
  std::string secret;
};

/// A GET request. One attempt: nothing is tried again, and no redirection is followed.
struct HttpRequest {
  using Clock = std::chrono::steady_clock;

  std::string url;
  std::vector<std::string> headers;  ///< "Name: value"
  std::optional<ByteRange> range;    ///< not empty; without one all is asked for
  std::optional<Signing> signing;
  uint64_t most_bytes = 0;                    ///< of a body that is wanted; a longer one is a fault
  Clock::time_point not_before{};             ///< when it is sent at the earliest
  std::chrono::milliseconds time{};           ///< from being sent until it is given up
  std::optional<Clock::time_point> deadline;  ///< when it is given up, sent or not; empty: by `time`
};

/// What came back. Only the body of a wanted status is kept: 206 for a range, else 200. The body of another 200, all of
/// an object, is not received.
struct HttpAnswer {
  int status = 0;     ///< 0: none came
  std::string fault;  ///< why the answer did not come, or not whole; empty: it did
  std::string etag;
  std::string content_range;
  std::string location;
  /// By the clock of the store, seconds since 1970: when it answered (Date and Age), and when the object was last
  /// written (Last-Modified). None where it does not say.
  std::optional<int64_t> answered;
  std::optional<int64_t> written;
  std::vector<std::byte> body;
  HttpRequest::Clock::time_point sent{};  ///< when the request was
};
using HttpDone = std::function<void(HttpAnswer answer)>;

struct HttpLimits {
  size_t requests = 16;                      ///< at a time
  std::chrono::milliseconds connect{3'000};  ///< for one connection
  std::chrono::milliseconds stall{3'000};    ///< without a byte
  /// Bytes of a body that come each second, on an average since the request was sent, while it is not given up; 0:
  /// none.
  uint64_t least_rate = 0;
  std::string authorities;  ///< file of certificates; empty: the system's
};

/// What the module does. A client has one thread, which calls back. `stop` ends the thread and drops what is
/// outstanding, whose callbacks are not called.
struct HttpFunctions {
  Result<void*> (*start)(const HttpLimits& limits);
  void (*stop)(void* client);
  void (*send)(void* client, HttpRequest request, HttpDone done);
};

/// The file of the module, see load_function().
inline constexpr const char* kHttpModule = "http_client.so";
/// The function that the module exports.
inline constexpr const char* kHttpSymbol = "surfcast_http_functions";
using HttpSymbolType = const HttpFunctions*();

}  // namespace surfcast::object_store

/// Exported by the module.
extern "C" [[gnu::visibility("default")]] surfcast::object_store::HttpSymbolType surfcast_http_functions;
