#include <iostream>
#include <memory>
#include <string>

#include <termios.h>
#include <unistd.h>

#include "client/commands.h"
#include "client/time_limits.h"
#include "client/token_store.h"

namespace surfcast::client {
namespace {

struct LoginCommand {
  std::string url;
  bool forget = false;
  TimeLimits limits;
};

/// A line of standard input, which a terminal does not show.
std::string read_secret() {
  termios shown{};
  const bool terminal = ::tcgetattr(STDIN_FILENO, &shown) == 0;
  if (terminal) {
    termios hidden = shown;
    hidden.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    std::cerr << "Token: ";
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &hidden);
  }
  std::string secret;
  std::cin >> secret;
  if (terminal) {
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &shown);
    std::cerr << '\n';
  }
  return secret;
}

/// A token is kept once the server has taken it.
Status log_in(const LoginCommand& command, int interrupt) {
  const Result<protocol::Endpoint> server = protocol::parse_endpoint(command.url);
  if (!server) throw CLI::ValidationError(server.error().message);
  if (command.forget) return store_token(token_store(), *server, "");
  ClientConfig config = command.limits.config(*server, interrupt);
  config.token = read_secret();
  if (config.token.empty()) return fail(ErrorKind::kInvalidInput, "expected a token on standard input");
  const Result<ServerConnection> connection = ServerConnection::open(*server, config);
  if (!connection) return fail(connection);
  return store_token(token_store(), *server, config.token);
}

}  // namespace

void add_login_command(CLI::App& app, int interrupt, Status& outcome) {
  const auto command = std::make_shared<LoginCommand>();
  CLI::App* sub = app.add_subcommand("login", "Keep a token for a server, read from standard input");
  sub->add_option("url", command->url, "HOST:PORT or ws://HOST:PORT; with TLS tcps:// or wss://")->required();
  sub->add_flag("--forget", command->forget, "forget the token that is kept for the server");
  command->limits.add_to(*sub);
  sub->callback([command, interrupt, &outcome] { outcome = log_in(*command, interrupt); });
}

}  // namespace surfcast::client
