#include "net/http_upload.h"

#include <algorithm>
#include <boost/beast/http/buffer_body.hpp>
#include <boost/beast/http/read.hpp>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "net/beast_text.h"
#include "net/http_connection.h"
#include "net/on_disk.h"
#include "net/redirect_error_to.h"
#include "net/uploads.h"
#include "service/model_name.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using boost::system::error_code;
using BodyParser = http::request_parser<http::buffer_body>;

/// Bytes that are read before they are written. Not a setting: UploadConfig::timeout is that of one piece.
constexpr size_t kPiece = size_t{64} << 10;

/// What a client announces of a scan.
struct Announced {
  std::filesystem::path target;
  std::optional<uint64_t> bytes;  ///< none: it says so at the end only
};

/// What an arriving file will be known by: the name of its model, or of the file itself if another one names it.
std::string name_of(const UploadConfig& config, const std::filesystem::path& target) {
  return is_data(config, target) ? target.filename().string() : service::model_name(target);
}

/// What no two files on their way have in common: the name of their model, or their path.
std::string key_of(const UploadConfig& config, const std::filesystem::path& target) {
  return is_data(config, target) ? target.string() : service::model_name(target);
}

/// Whether a scan may be sent, and which one.
Result<Announced> admit(const NetContext& context, const HeadParser& head, const access::AuthorizedUpload& upload) {
  const UploadConfig& config = context.config.uploads;
  if (context.draining) return fail(ErrorKind::kUnavailable, "the server is stopping");
  if (config.folder.empty()) return fail(ErrorKind::kUnsupported, "this server takes no scans; --uploads lets it");
  Announced scan;
  if (const auto length = head.content_length()) scan.bytes = *length;
  Result<std::filesystem::path> target = upload_target(config, upload.sender(), upload.file());
  if (!target) return fail(target);
  scan.target = std::move(*target);
  if (scan.bytes.value_or(0) > config.bytes) return fail(too_large(config.bytes));
  if (context.uploads.contains(key_of(config, scan.target))) {
    return fail(ErrorKind::kInvalidInput, "a scan of that name is being received");
  }
  if (context.uploads.size() >= config.at_once) {
    return fail(ErrorKind::kUnavailable, "busy: other scans are being received");
  }
  return scan;
}

/// Space that is kept for the scans on their way.
uint64_t reserved_bytes(const NetContext& context) {
  return std::accumulate(context.uploads.begin(), context.uploads.end(), uint64_t{0},
                         [](uint64_t sum, const auto& upload) { return sum + upload.second; });
}

/// Reads a body piece by piece. The next piece is read once the last one is written.
asio::awaitable<Status> receive_body(NetContext& context, HttpConnection& connection, BodyParser& parser,
                                     std::shared_ptr<IncomingScan> scan) {
  const auto piece = std::make_shared<std::vector<std::byte>>(kPiece);
  while (!parser.is_done()) {
    http::buffer_body::value_type& body = parser.get().body();
    body = {piece->data(), piece->size(), true};
    connection.stream().socket().expires_after(context.config.uploads.timeout);
    error_code code;
    co_await http::async_read(connection.stream(), connection.buffer(), parser, redirect_error_to(code));
    if (code && code != http::error::need_buffer) {
      co_return fail(ErrorKind::kCancelled, "the scan did not arrive: " + code.message());
    }
    const size_t count = piece->size() - body.size;
    const auto append = [=] { return scan->append(std::span(*piece).first(count)); };
    Status written = co_await on_disk<Status>(context, append);
    if (!written) co_return written;
  }
  co_return Status();
}

asio::awaitable<Status> store(NetContext& context, HttpConnection& connection, HeadParser& head, Announced announced,
                              uint64_t reserved) {
  const UploadConfig& config = context.config.uploads;
  using Created = Result<std::shared_ptr<IncomingScan>>;
  const auto create = [&config, announced, reserved] {
    return IncomingScan::create(config, announced.target, announced.bytes, reserved).map([](IncomingScan created) {
      return std::make_shared<IncomingScan>(std::move(created));
    });
  };
  Created scan = co_await on_disk<Created>(context, create);
  if (!scan) co_return fail(scan);
  co_await connection.say_continue(head);
  BodyParser body{std::move(head)};
  body.body_limit(boost::none);  // IncomingScan counts
  Status status = co_await receive_body(context, connection, body, *scan);
  const auto finish = [scan = *scan] { return scan->finish(); };
  if (status) status = co_await on_disk<Status>(context, finish);
  context.disk->post([scan = std::move(*scan)] {});  // what is not whole is removed there
  co_return status;
}

UploadOutcome refusal_of(const Error& error) {
  return {error.kind == ErrorKind::kLimit ? error_answer(error, 413) : error_answer(error)};
}

}  // namespace

std::string_view scheme_of(const HeadParser::value_type& request, bool tls) {
  return tls ? "https" : view_of(request["X-Forwarded-Proto"]);
}

RequestOrigin origin_of(const HeadParser::value_type& request, bool tls) {
  return {view_of(request[http::field::host]), view_of(request[http::field::origin]), scheme_of(request, tls)};
}

asio::awaitable<UploadOutcome> receive_scan(NetContext& context, HttpConnection& connection, HeadParser& head,
                                            const access::AuthorizedUpload& upload) {
  const auto& request = head.get();
  const Status page = check_origin(origin_of(request, connection.tls()), context.config.allowed_origins);
  UploadOutcome outcome;
  if (!page) {
    outcome.answer = error_answer(page.error(), 403);
    co_return outcome;
  }
  const Result<Announced> scan = admit(context, head, upload);
  if (!scan) co_return refusal_of(scan.error());
  const std::string name = name_of(context.config.uploads, scan->target);
  const std::string key = key_of(context.config.uploads, scan->target);
  const uint64_t reserved = reserved_bytes(context);
  context.uploads.emplace(key, scan->bytes.value_or(context.config.uploads.bytes));
  const Status stored = co_await store(context, connection, head, *scan, reserved);
  context.uploads.erase(key);
  if (!stored) co_return refusal_of(stored.error());
  outcome.answer = uploaded_answer(is_data(context.config.uploads, scan->target) ? "file" : "model", name);
  outcome.whole = true;
  co_return outcome;
}

}  // namespace surfcast::net
