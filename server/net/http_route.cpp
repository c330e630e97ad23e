#include "net/http_route.h"

#include <array>
#include <utility>

#include "protocol/url_query.h"

namespace surfcast::net {
namespace {

using Kind = HttpRoute::Kind;

constexpr std::string_view kModels = "/api/models";
constexpr std::string_view kUploads = "/api/uploads/";
/// What may follow the name of a model.
constexpr std::array<std::pair<std::string_view, Kind>, 5> kOfModel{{
    {"/image", Kind::kPicture},
    {"/pick", Kind::kPick},
    {"/profile", Kind::kProfile},
    {"/points", Kind::kPoints},
    {"/annotations", Kind::kAnnotations},
}};
constexpr std::array<std::pair<std::string_view, Kind>, 8> kPlaces{{
    {"/", Kind::kPage},
    {kModels, Kind::kModels},
    {"/ws", Kind::kWebSocket},
    {"/healthz", Kind::kHealth},
    {"/readyz", Kind::kReady},
    {"/metrics", Kind::kMetrics},
    {"/api/login", Kind::kLogin},
    {"/api/logout", Kind::kLogout},
}};

tl::unexpected<Error> no_such_place(std::string_view path) {
  return fail(ErrorKind::kNotFound, "there is nothing at " + std::string(path));
}

/// "NAME", or "NAME/image" and the like: what follows "/api/models/".
Result<HttpRoute> route_model(std::string_view rest, std::string_view query) {
  HttpRoute route{Kind::kModel, {}, std::string(query)};
  for (const auto& [suffix, kind] : kOfModel) {
    if (!rest.ends_with(suffix)) continue;
    route.kind = kind;
    rest.remove_suffix(suffix.size());
    break;
  }
  if (rest.empty() || rest.find('/') != std::string_view::npos) return no_such_place(kModels);
  Result<std::string> name = protocol::decode_escapes(rest);
  if (!name) return fail(name.error());
  route.model = std::move(*name);
  return route;
}

}  // namespace

Result<HttpRoute> route_http(std::string_view target) {
  const size_t mark = target.find('?');
  const std::string_view path = target.substr(0, mark);
  const std::string_view query = mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1);
  for (const auto& [place, kind] : kPlaces) {
    if (path == place) return HttpRoute{kind, {}, std::string(query)};
  }
  if (path.starts_with(kUploads)) {
    return protocol::decode_escapes(path.substr(kUploads.size())).map([](std::string name) {
      return HttpRoute{Kind::kUpload, std::move(name), {}};
    });
  }
  const std::string prefix = std::string(kModels) + "/";
  if (path.starts_with(prefix)) return route_model(path.substr(prefix.size()), query);
  return no_such_place(path);
}

}  // namespace surfcast::net
