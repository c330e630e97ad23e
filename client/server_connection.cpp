#include "client/server_connection.h"

#include <algorithm>
#include <span>
#include <utility>

#include "protocol/errors.h"
#include "protocol/framing.h"

namespace surfcast::client {

ServerConnection::ServerConnection(const protocol::Endpoint& server, const ClientConfig& config,
                                   std::unique_ptr<MessageChannel> channel)
    : endpoint_(server), config_(config), channel_(std::move(channel)) {}

Result<ServerConnection> ServerConnection::open(const protocol::Endpoint& server, const ClientConfig& config) {
  const Clock::time_point deadline = Clock::now() + config.connect;
  auto channel = connect_channel(server, deadline, config.interrupt, config.ca, config.model);
  if (!channel) {
    return fail(channel.error().kind, protocol::to_string(server) + ": cannot connect: " + channel.error().message);
  }
  ServerConnection connection(server, config, std::move(*channel));
  if (Status status = connection.exchange_hellos(deadline); !status) return connection.failed(status.error());
  if (Status status = connection.authenticate(); !status) return fail(status);
  return connection;
}

/// Ids of views that go on are not given to anything else.
Result<wire::Resumed> ServerConnection::resume(const std::string& session) {
  wire::Request request;
  request.mutable_resume()->set_session(session);
  Result<wire::Answer> answer = ask(std::move(request));
  if (!answer && answer.error().kind == ErrorKind::kUnsupported) return wire::Resumed();
  if (!answer) return fail(answer);
  for (const uint64_t view : answer->resumed().views()) last_id_ = std::max(last_id_, view);
  return std::move(*answer->mutable_resumed());
}

/// A server that wants no token takes any; one that is too old to know of tokens wants none.
Status ServerConnection::authenticate() {
  if (config_.token.empty()) return {};
  wire::Request request;
  request.mutable_authenticate()->set_token(config_.token);
  const Result<wire::Answer> answer = ask(std::move(request));
  if (answer || answer.error().kind == ErrorKind::kUnsupported) return {};
  return fail(answer);
}

tl::unexpected<Error> ServerConnection::failed(ErrorKind kind, const std::string& what) const {
  return fail(kind, protocol::to_string(endpoint_) + ": " + what);
}

Status ServerConnection::exchange_hellos(Clock::time_point deadline) {
  return channel_
      ->exchange_hellos(protocol::encode_hello(protocol::make_client_hello("surfcast", config_.model)), deadline)
      .and_then([](const MessageChannel::Bytes& answer) { return protocol::decode_hello(answer); })
      .and_then([this](protocol::Hello hello) {
        server_ = std::move(hello);
        return protocol::check_server_hello(server_);
      });
}

Status ServerConnection::send_as(uint64_t id, wire::Request request) {
  request.set_id(id);
  const std::string message = request.SerializeAsString();
  if (message.size() > protocol::kMaxRequestBytes)
    return fail(ErrorKind::kLimit, "the request is larger than a server reads");
  const Status written = channel_->write(std::as_bytes(std::span(message)), Clock::now() + config_.answer);
  return written ? written : failed(written.error());
}

Result<uint64_t> ServerConnection::send(wire::Request request) {
  if (Status status = send_as(++last_id_, std::move(request)); !status) return fail(status);
  return last_id_;
}

Result<std::optional<wire::Answer>> ServerConnection::receive_until(Clock::time_point deadline) {
  const auto message = channel_->read(deadline);
  if (!message && message.error().kind == ErrorKind::kUnavailable) return std::nullopt;
  if (!message) return failed(message.error());
  bytes_received_ += message->size();
  wire::Answer answer;
  if (Status status = protocol::decode_message(*message, answer); !status) return failed(status.error());
  return answer;
}

Result<wire::Answer> ServerConnection::receive() {
  Result<std::optional<wire::Answer>> answer = receive_until(Clock::now() + config_.answer);
  if (!answer) return fail(answer);
  if (!*answer) return failed(ErrorKind::kUnavailable, "timed out");
  return std::move(**answer);
}

Result<wire::Answer> ServerConnection::ask(wire::Request request) {
  const Result<uint64_t> id = send(std::move(request));
  if (!id) return fail(id);
  for (;;) {
    Result<wire::Answer> answer = receive();
    if (!answer && answer.error().kind == ErrorKind::kCancelled) {
      wire::Request cancel;
      cancel.mutable_cancel()->set_request_id(*id);
      static_cast<void>(send(std::move(cancel)));  // may fail: closing the connection cancels the request as well
    }
    if (!answer) return answer;
    if (answer->id() != *id && answer->id() != 0) continue;
    if (!answer->has_error()) return answer;
    return failed(protocol::from_wire(answer->error()));
  }
}

Result<wire::Answer> ask_server(const protocol::Endpoint& server, const ClientConfig& config, wire::Request request) {
  return ServerConnection::open(server, config).and_then([&request](ServerConnection connection) {
    return connection.ask(std::move(request));
  });
}

}  // namespace surfcast::client
