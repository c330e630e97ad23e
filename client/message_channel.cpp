#include "client/message_channel.h"

#include <utility>

#include "client/client_socket.h"
#include "protocol/url_query.h"

namespace surfcast::client {

Result<std::unique_ptr<MessageChannel>> connect_channel(const protocol::Endpoint& server,
                                                        MessageChannel::TimePoint deadline, int interrupt,
                                                        const std::string& ca, const std::string& model) {
  auto socket = std::make_unique<ClientSocket>();
  if (Status status = socket->connect(server, deadline, interrupt); !status) return fail(status);
  if (server.encrypted) {
    if (Status status = socket->encrypt(server.host, ca, deadline); !status) return fail(status);
  }
  if (!server.websocket) return make_framed_channel(std::move(socket));
  const std::string target = model.empty() ? "/ws" : "/ws?model=" + protocol::encode_escapes(model);
  return make_websocket_channel(std::move(socket), protocol::to_string(server), target);
}

}  // namespace surfcast::client
