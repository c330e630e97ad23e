#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "base/log_limit.h"
#include "object_store/http_module.h"
#include "object_store/object_url.h"
#include "object_store/range_answer.h"
#include "object_store/store_config.h"

namespace surfcast::object_store {

/// The pause before a request is sent again, after so many attempts: twice as long each time, and longer or shorter by
/// up to a half, so that clients that failed together do not come back together. `random` is in [0, 1).
std::chrono::milliseconds retry_pause(unsigned attempts, double random);

/// Sends requests to stores, and those again that may succeed later. Thread-safe.
class HttpClient {
 public:
  /// Loads the module that uses libcurl, which links 30 other libraries: programs that read local files alone do not
  /// load it.
  static Result<std::unique_ptr<HttpClient>> start(const StoreConfig& config);

  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;
  ~HttpClient();

  using Check = std::function<std::optional<AnswerFault>(const HttpAnswer&)>;
  using Done = std::function<void(Result<HttpAnswer>)>;

  /// A request for what is at a place, or a part of it; `query` begins with "?" or is empty. Signed where it has to be.
  [[nodiscard]] HttpRequest request(const StorePlace& place, const std::string& query = {}) const;
  /// Sends a request until `check` finds no fault in the answer, or none that passes, or the time is over. `done` is
  /// called by a thread of the client, and not at all if the client ends before.
  void send(HttpRequest request, Check check, Done done) const;
  [[nodiscard]] Result<HttpAnswer> send_and_wait(HttpRequest request, const Check& check) const;
  [[nodiscard]] const StoreConfig& config() const { return config_; }

 private:
  struct Attempts;

  HttpClient(const StoreConfig& config, const HttpFunctions& functions, void* client)
      : config_(config), functions_(functions), client_(client), lines_(config.log_lines.value_or(0)) {}
  void attempt(const std::shared_ptr<Attempts>& attempts) const;

  [[nodiscard]] Error error_of(const HttpRequest& request, AnswerFault fault) const;

  const StoreConfig config_;
  const HttpFunctions& functions_;
  void* client_;
  mutable LogLimit lines_;  ///< of the client's thread
};

}  // namespace surfcast::object_store
