#pragma once

#include <string>
#include <string_view>

#include "base/result.h"

namespace surfcast::net {

/// What an HTTP request asks for.
struct HttpRoute {
  enum class Kind {
    kPage,
    kModels,
    kModel,
    kPicture,
    kPick,
    kProfile,
    kPoints,
    kAnnotations,
    kWebSocket,
    kUpload,
    kHealth,
    kReady,
    kMetrics,
    kLogin,
    kLogout
  };
  Kind kind = Kind::kPage;
  std::string model;     ///< of kModel and what is asked of one; of kUpload the file's name
  std::string query;     ///< of kPicture, kPick, kProfile and kPoints, still escaped
  std::string accept{};  ///< the header of the request
};

/// Where the target of a request leads: kNotFound for no such place, kInvalidInput for a malformed one.
Result<HttpRoute> route_http(std::string_view target);

}  // namespace surfcast::net
