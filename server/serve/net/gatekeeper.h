#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "access/authorization.h"
#include "access/principal.h"
#include "access/token_table.h"
#include "base/result.h"
#include "net/clients.h"
#include "service/client_shares.h"

namespace surfcast::net {

/// Who may come in, by the file of tokens. Used on the thread of the sockets.
class Gatekeeper {
 public:
  using User = std::shared_ptr<const access::Principal>;
  using Clock = std::chrono::steady_clock;

  /// `tokens` empty: everybody may do everything.
  explicit Gatekeeper(std::filesystem::path tokens) : file_(std::move(tokens)) {}

  /// Reads the file, again if it has changed. After an error the former tokens hold.
  Status read();
  [[nodiscard]] bool wants_tokens() const { return !file_.empty(); }
  /// Whether that user, null for none, may ask for models.
  [[nodiscard]] bool admits(const User& user) const { return !wants_tokens() || user; }

  /// What that user, null for none, may do with models.
  [[nodiscard]] access::Rights rights(const User& user) const;

  /// The user with that secret; null for none. `client`, as in client_name, is who says it.
  User enter(std::string_view secret, const std::string& client);
  /// What a client waits for its answer, who named too many wrong secrets lately.
  [[nodiscard]] std::chrono::milliseconds penalty(const std::string& client) const;
  /// Why a user has to leave; empty: it may stay.
  [[nodiscard]] std::string why_ended(const User& user) const;

  /// Why a user, null for none, may not have another connection; empty: they may.
  [[nodiscard]] std::string refusal_of_connection(const User& user) const;
  /// Likewise another view.
  [[nodiscard]] std::string refusal_of_view(const User& user) const;
  /// Counts a connection or a view of a user for as long as the result lives; nothing of nobody.
  [[nodiscard]] std::optional<Counted> count(const User& user, size_t Clients::Counts::*what) const;
  /// Connections that users have open.
  [[nodiscard]] size_t connections() const { return users_->all().connections; }
  [[nodiscard]] uint64_t denied() const { return denied_; }

 private:
  struct Failures {
    Clock::time_point since;
    size_t count = 0;
  };

  std::filesystem::path file_;
  std::shared_ptr<const access::TokenTable> table_;
  std::map<std::string, Failures> failures_;                                    ///< of the last minute, by client
  std::shared_ptr<Clients> users_ = std::make_shared<Clients>(ClientLimits{});  ///< what they have open, by their names
  uint64_t denied_ = 0;                                                         ///< wrong secrets
};

/// By which the service knows who asks, and gives turns: the user, on whatever connections they come, or, if that is
/// null, the client (see client_name).
service::ClientId client_id(const std::string& client, const Gatekeeper::User& user);

}  // namespace surfcast::net
