#include "net/http_annotations.h"

#include <optional>
#include <string_view>
#include <utility>

#include "net/annotations.h"
#include "net/await_answer.h"
#include "net/beast_text.h"
#include "net/http_connection.h"
#include "net/on_disk.h"
#include "net/upgrade.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;

HttpAnswer answer_of_document(const Result<Annotations>& annotations, bool writable) {
  if (!annotations) {
    const Error& error = annotations.error();
    if (error.kind == ErrorKind::kReplaced) return error_answer(error, 412);
    return error.kind == ErrorKind::kLimit ? error_answer(error, 413) : error_answer(error);
  }
  HttpAnswer answer = text_answer(annotations->document, "application/json");
  answer.headers = {{"ETag", '"' + annotations->edition + '"'},
                    {"Cache-Control", "no-cache"},
                    {"Allow", writable ? "GET, HEAD, PUT" : "GET, HEAD"}};
  return answer;
}

/// The edition of an If-Match header; nothing: any.
std::optional<std::string> edition_in(std::string_view if_match) {
  if (if_match.empty() || if_match == "*") return std::nullopt;
  if (if_match.size() >= 2 && if_match.front() == '"' && if_match.back() == '"') {
    if_match = if_match.substr(1, if_match.size() - 2);
  }
  return std::string(if_match);
}

/// Whether there is such a model for the client, and a place for its annotations.
asio::awaitable<Status> check_model(NetContext& context, const access::AuthorizedModel& model,
                                    service::ClientId client) {
  if (context.config.annotations.folder.empty()) {
    co_return fail(ErrorKind::kUnsupported, "this server keeps no annotations; --annotations lets it");
  }
  const auto description = co_await answer_of<Result<service::ModelDescription>>(
      [&](auto done) { context.service.describe_model(model, std::move(done), client); });
  if (!description) co_return fail(description);
  co_return Status();
}

}  // namespace

asio::awaitable<HttpAnswer> answer_annotations(NetContext& context, const access::AuthorizedModel& model, bool writable,
                                               service::ClientId client) {
  const Status known = co_await check_model(context, model, client);
  if (!known) co_return error_answer(known.error());
  const auto read = [&config = context.config.annotations, name = model.name()] {
    return read_annotations(config, name);
  };
  const auto annotations = co_await on_disk<Result<Annotations>>(context, read);
  co_return answer_of_document(annotations, writable);
}

asio::awaitable<HttpAnswer> receive_annotations(NetContext& context, HttpConnection& connection, HeadParser& head,
                                                const access::AuthorizedAnnotations& annotations,
                                                service::ClientId client) {
  const Status page = check_origin(origin_of(head.get(), connection.tls()), context.config.allowed_origins);
  if (!page) co_return error_answer(page.error(), 403);
  const AnnotationConfig& config = context.config.annotations;
  const Status known = co_await check_model(context, annotations.model(), client);
  if (!known) co_return error_answer(known.error());
  const std::optional<std::string> replaced = edition_in(view_of(head.get()[http::field::if_match]));
  const std::optional<std::string> document = co_await connection.read_body(head, config.bytes);
  if (!document) {
    const Error error{ErrorKind::kLimit, "the annotations did not arrive, or are longer than allowed"};
    co_return error_answer(error, 413);
  }
  const auto write = [&config, name = annotations.model().name(), document = *document, replaced] {
    return write_annotations(config, name, document, replaced);
  };
  const auto written = co_await on_disk<Result<Annotations>>(context, write);
  co_return answer_of_document(written, /*writable=*/true);
}

}  // namespace surfcast::net
