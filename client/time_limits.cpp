#include "client/time_limits.h"

#include <cstdlib>
#include <fstream>

#include "client/token_store.h"
#include "protocol/request_flags.h"

namespace surfcast::client {
namespace {

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<int64_t>(seconds * 1e3));
}

}  // namespace

void TimeLimits::add_to(CLI::App& command) {
  command.add_option("--connect-timeout", connect, "timeout of connecting, seconds (default 10)")
      ->envname(protocol::environment_name("connect-timeout"))
      ->check(CLI::Range(0.001, 86400.0));
  command.add_option("--timeout", answer, "timeout of an answer, seconds (default 120)")
      ->envname(protocol::environment_name("timeout"))
      ->check(CLI::Range(0.001, 86400.0));
  command
      .add_option("--ca", ca,
                  "certificates to trust with tcps:// and wss://, a PEM file (default: those of the system)")
      ->envname(protocol::environment_name("ca"))
      ->type_name("FILE");
  command
      .add_option("--token-file", token_file,
                  "file with the token that is named to the server (default: the variable SURFCAST_TOKEN, or what "
                  "surfcast login has kept)")
      ->envname(protocol::environment_name("token-file"))
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
}

std::string TimeLimits::token_for(const protocol::Endpoint& server) const {
  if (!token_file.empty()) {
    std::string token;
    std::ifstream(token_file) >> token;
    return token;
  }
  const char* const named = std::getenv("SURFCAST_TOKEN");
  return named != nullptr ? named : stored_token(token_store(), server);
}

ClientConfig TimeLimits::config(const protocol::Endpoint& server, int interrupt) const {
  return {.connect = milliseconds(connect),
          .answer = milliseconds(answer),
          .interrupt = interrupt,
          .token = token_for(server),
          .ca = ca};
}

ClientConfig TimeLimits::config(const protocol::ModelUrl& url, int interrupt) const {
  ClientConfig with_model = config(url.server, interrupt);
  with_model.model = url.model;
  return with_model;
}

}  // namespace surfcast::client
