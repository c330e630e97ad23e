// The part of a conversation that is about who the client is.
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <utility>

#include "net/conversation.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;

Bytes encode_denial(uint64_t id, const std::string& reason) {
  wire::Answer answer;
  answer.set_id(id);
  answer.mutable_error()->set_code(wire::ERROR_CODE_DENIED);
  answer.mutable_error()->set_message(reason);
  return encode_answer(answer);
}

}  // namespace

/// Turns of the renderer go to the user, on whatever connections it comes.
void Conversation::welcome(const Gatekeeper::User& user) {
  user_ = user;
  client_.id = client_id(client_name_, user);
  counted_user_.reset();
  counted_user_ = context_->gate->count(user, &Clients::Counts::connections);
}

void Conversation::handle_authenticate(const wire::Request& request) {
  const uint64_t id = request.id();
  Gatekeeper& gate = *context_->gate;
  const Gatekeeper::User user = gate.enter(request.authenticate().token(), client_name_);
  if (!user && gate.wants_tokens()) return deny(id, "the token is not known here, or has ended");
  if (user && !views_.empty()) return deny(id, "views are open with another token");
  if (const std::string busy = gate.refusal_of_connection(user); !busy.empty()) return deny(id, busy);
  if (user) welcome(user);
  if (user) audit_token("allowed", "");
  wire::Answer answer;
  answer.set_id(id);
  answer.mutable_authenticated()->set_name(user ? user->name : "");
  send(encode_answer(answer));
}

/// Ends the conversation. Whoever guesses waits for it.
void Conversation::deny(uint64_t id, const std::string& reason) {
  ++context_->metrics.errors;
  audit_token("denied", reason);
  context_->sessions.forget(std::exchange(session_, {}));
  const auto writer = writer_;
  const auto penalty = std::make_shared<asio::steady_timer>(executor_, context_->gate->penalty(client_name_));
  abandon();
  if (!writer) return;
  penalty->async_wait([writer, penalty, last = encode_denial(id, reason)](const boost::system::error_code&) mutable {
    writer->end(std::move(last));
  });
}

void Conversation::audit_token(std::string_view outcome, const std::string& reason) const {
  if (!context_->audit) return;
  context_->audit->write({.what = "token",
                          .who = owner(),
                          .client = client_name_,
                          .connection = client_.session,
                          .outcome = outcome,
                          .reason = reason});
}

void Conversation::check_user() {
  const std::string reason = context_->gate->why_ended(user_);
  if (reason.empty() || !writer_) return;
  for (const auto& [id, opened] : views_) send(encode_denial(id, reason));
  deny(0, reason);
}

}  // namespace surfcast::net
