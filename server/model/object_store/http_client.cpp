#include "object_store/http_client.h"

#include <algorithm>
#include <future>
#include <random>
#include <utility>

#include "base/load_module.h"
#include "base/log.h"

namespace surfcast::object_store {
namespace {

using Clock = HttpRequest::Clock;

const Result<const HttpFunctions*>& load_http() {
  static const Result<const HttpFunctions*> functions =
      load_function(kHttpModule, kHttpSymbol)
          .map([](void* symbol) { return reinterpret_cast<HttpSymbolType*>(symbol)(); })
          .map_error([](const Error& error) {
            return Error{error.kind, "models in stores: " + error.message};
          });
  return functions;
}

/// S3 wants this header of every signed request: the SHA-256 of the body, which is empty. libcurl 7.88 signs it but
/// does not add it.
constexpr const char* kHashOfNothing =
    "x-amz-content-sha256: e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";

double random_share() {
  thread_local std::mt19937 engine{std::random_device{}()};
  return std::uniform_real_distribution<double>(0, 1)(engine);
}

}  // namespace

std::chrono::milliseconds retry_pause(unsigned attempts, double random) {
  constexpr double kFirstMs = 100;
  constexpr unsigned kMaxDoublings = 6;
  const double doubled = kFirstMs * static_cast<double>(1U << std::min(attempts - 1, kMaxDoublings));
  return std::chrono::milliseconds(static_cast<int64_t>(doubled * (0.5 + random)));
}

/// A request and what has become of it.
struct HttpClient::Attempts {
  HttpRequest request;
  Check check;
  Done done;
  unsigned count = 0;
};

Result<std::unique_ptr<HttpClient>> HttpClient::start(const StoreConfig& config) {
  const Result<const HttpFunctions*>& functions = load_http();
  if (!functions) return fail(functions);
  const HttpLimits limits{config.requests, config.connect_timeout, config.stall_timeout, config.least_rate,
                          config.authorities.string()};
  const Result<void*> client = (*functions)->start(limits);
  if (!client) return fail(client);
  return std::unique_ptr<HttpClient>(new HttpClient(config, **functions, *client));
}

HttpClient::~HttpClient() {
  functions_.stop(client_);
}

HttpRequest HttpClient::request(const StorePlace& place, const std::string& query) const {
  HttpRequest request;
  request.url = place.url + query;
  const Credentials& credentials = config_.credentials;
  if (place.s3 && credentials.known()) {
    request.signing = Signing{"aws:amz:" + config_.region + ":s3", credentials.key, credentials.secret};
    request.headers.emplace_back(kHashOfNothing);
    if (!credentials.session.empty()) request.headers.push_back("x-amz-security-token: " + credentials.session);
  }
  return request;
}

void HttpClient::send(HttpRequest request, Check check, Done done) const {
  request.time = config_.timeout;
  attempt(std::make_shared<Attempts>(Attempts{std::move(request), std::move(check), std::move(done)}));
}

void HttpClient::attempt(const std::shared_ptr<Attempts>& attempts) const {
  ++attempts->count;
  functions_.send(client_, attempts->request, [this, attempts](HttpAnswer answer) {
    std::optional<AnswerFault> fault = attempts->check(answer);
    if (!fault) return attempts->done(std::move(answer));
    std::optional<Clock::time_point>& deadline = attempts->request.deadline;
    if (!deadline) deadline = answer.sent + config_.timeout;
    const Clock::time_point again = Clock::now() + retry_pause(attempts->count, random_share());
    if (!fault->again || attempts->count > config_.retries || again >= *deadline) {
      return attempts->done(fail(error_of(attempts->request, std::move(*fault))));
    }
    attempts->request.not_before = again;
    attempt(attempts);
  });
}

/// The error of a request that failed for good. The log has the line about it, or the error itself says all.
Error HttpClient::error_of(const HttpRequest& request, AnswerFault fault) const {
  const std::string message = fault.error.message + (fault.detail.empty() ? "" : ": " + fault.detail);
  if (!config_.log_lines) return {fault.error.kind, message};
  if (fault.error.kind == ErrorKind::kReplaced) return std::move(fault.error);
  if (const std::optional<size_t> left_out = lines_.admit(Clock::now())) {
    spdlog::warn("{}: {}{}", shown_url(request.url), message,
                 *left_out > 0 ? ", and " + std::to_string(*left_out) + " such lines before were left out" : "");
  }
  return std::move(fault.error);
}

Result<HttpAnswer> HttpClient::send_and_wait(HttpRequest request, const Check& check) const {
  auto promise = std::make_shared<std::promise<Result<HttpAnswer>>>();
  send(std::move(request), check, [promise](Result<HttpAnswer> answer) { promise->set_value(std::move(answer)); });
  return promise->get_future().get();
}

}  // namespace surfcast::object_store
