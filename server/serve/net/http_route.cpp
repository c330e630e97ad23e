#include "net/http_route.h"

#include <array>
#include <utility>

#include "protocol/url_query.h"

namespace surfcast::net {
namespace {

using Resource = ModelRoute::Resource;

constexpr std::string_view kModels = "/api/models";
constexpr std::string_view kUploads = "/api/uploads/";
/// What may follow the name of a model.
constexpr std::array<std::pair<std::string_view, Resource>, 5> kOfModel{{
    {"/image", Resource::kPicture},
    {"/pick", Resource::kPick},
    {"/profile", Resource::kProfile},
    {"/points", Resource::kPoints},
    {"/annotations", Resource::kAnnotations},
}};
constexpr std::array<std::pair<std::string_view, ServerRoute>, 8> kOfServer{{
    {"/", ServerRoute::kPage},
    {kModels, ServerRoute::kModels},
    {"/ws", ServerRoute::kWebSocket},
    {"/healthz", ServerRoute::kHealth},
    {"/readyz", ServerRoute::kReady},
    {"/metrics", ServerRoute::kMetrics},
    {"/api/login", ServerRoute::kLogin},
    {"/api/logout", ServerRoute::kLogout},
}};

tl::unexpected<Error> no_route(std::string_view path) {
  return fail(ErrorKind::kNotFound, "there is nothing at " + std::string(path));
}

/// "NAME", or "NAME/image" and the like: what follows "/api/models/".
Result<HttpRoute> parse_model_route(std::string_view rest, std::string_view query) {
  Resource resource = Resource::kDescription;
  for (const auto& [suffix, named] : kOfModel) {
    if (!rest.ends_with(suffix)) continue;
    resource = named;
    rest.remove_suffix(suffix.size());
    break;
  }
  if (rest.empty() || rest.find('/') != std::string_view::npos) return no_route(kModels);
  Result<std::string> name = protocol::decode_escapes(rest);
  if (!name) return fail(name);
  return ModelRoute{resource, std::move(*name), std::string(query)};
}

Result<HttpRoute> parse_route(std::string_view path, std::string_view query) {
  for (const auto& [known, route] : kOfServer) {
    if (path == known) return route;
  }
  if (path.starts_with(kUploads)) {
    return protocol::decode_escapes(path.substr(kUploads.size())).map([](std::string file) {
      return HttpRoute(UploadRoute{std::move(file)});
    });
  }
  const std::string prefix = std::string(kModels) + "/";
  if (path.starts_with(prefix)) return parse_model_route(path.substr(prefix.size()), query);
  return no_route(path);
}

}  // namespace

HttpTarget parse_target(std::string_view target) {
  const size_t mark = target.find('?');
  const std::string_view path = target.substr(0, mark);
  const std::string_view query = mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1);
  return {std::string(path), parse_route(path, query)};
}

bool leads_to(const Result<HttpRoute>& route, ServerRoute wanted) {
  const ServerRoute* const of_server = route ? std::get_if<ServerRoute>(&*route) : nullptr;
  return of_server != nullptr && *of_server == wanted;
}

SentBody body_of(const Result<HttpRoute>& route, HttpMethod method) {
  if (!route) return SentBody::kNone;
  const bool login = leads_to(route, ServerRoute::kLogin) || leads_to(route, ServerRoute::kLogout);
  if (login && method == HttpMethod::kPost) return SentBody::kLogin;
  if (method != HttpMethod::kPut) return SentBody::kNone;
  if (std::holds_alternative<UploadRoute>(*route)) return SentBody::kScan;
  const ModelRoute* const of_model = std::get_if<ModelRoute>(&*route);
  return of_model != nullptr && of_model->resource == Resource::kAnnotations ? SentBody::kAnnotations : SentBody::kNone;
}

}  // namespace surfcast::net
