#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "base/result.h"

namespace surfcast::net {

/// What is asked of the server as a whole.
enum class ServerRoute { kPage, kModels, kWebSocket, kHealth, kReady, kMetrics, kLogin, kLogout };

/// What is asked of one model.
struct ModelRoute {
  enum class Resource { kDescription, kPicture, kPick, kProfile, kPoints, kAnnotations };
  Resource resource = Resource::kDescription;
  std::string model;
  std::string query;  ///< still escaped
  bool operator==(const ModelRoute&) const = default;
};

/// Where a scan is sent.
struct UploadRoute {
  std::string file;  ///< its name
  bool operator==(const UploadRoute&) const = default;
};

using HttpRoute = std::variant<ServerRoute, ModelRoute, UploadRoute>;

/// The target of a request, taken apart.
struct HttpTarget {
  std::string path;         ///< still escaped, without the query: it may be that of a file of the viewer
  Result<HttpRoute> route;  ///< kNotFound: there is none; kInvalidInput: it is malformed
};

/// Takes the target of a request apart. Nothing else does.
HttpTarget parse_target(std::string_view target);

/// The method of a request, as far as routes differ by it.
enum class HttpMethod { kGet, kPut, kPost, kOther };  // kGet: or HEAD

/// Whether a route is that one of the server as a whole.
bool leads_to(const Result<HttpRoute>& route, ServerRoute wanted);

/// What a request with a body sends.
enum class SentBody { kNone, kLogin, kAnnotations, kScan };
SentBody body_of(const Result<HttpRoute>& route, HttpMethod method);

}  // namespace surfcast::net
