#include "client/token_store.h"

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include <sys/stat.h>

#include "base/atomic_file.h"
#include "base/json_text.h"

namespace surfcast::client {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string key_of(const protocol::Endpoint& server) {
  return (server.encrypted ? "tcps://" : "tcp://") + protocol::to_string(server);
}

/// An object of tokens by server; an empty one if there is no such file.
json read_store(const fs::path& store) {
  std::ifstream stream(store);
  json tokens = parse_json_text(std::string(std::istreambuf_iterator<char>(stream), {}));
  return tokens.is_object() ? tokens : json::object();
}

}  // namespace

fs::path token_store() {
  const char* const config = std::getenv("XDG_CONFIG_HOME");
  if (config != nullptr && *config != '\0') return fs::path(config) / "surfcast/tokens.json";
  const char* const home = std::getenv("HOME");
  return home == nullptr ? fs::path() : fs::path(home) / ".config/surfcast/tokens.json";
}

std::string stored_token(const fs::path& store, const protocol::Endpoint& server) {
  if (store.empty()) return {};
  const json tokens = read_store(store);
  const auto found = tokens.find(key_of(server));
  return found != tokens.end() && found->is_string() ? found->get<std::string>() : std::string();
}

Status store_token(const fs::path& store, const protocol::Endpoint& server, const std::string& token) {
  if (store.empty()) return fail(ErrorKind::kNotFound, "there is no home folder to keep a token in");
  json tokens = read_store(store);
  if (token.empty()) {
    tokens.erase(key_of(server));
  } else {
    tokens[key_of(server)] = token;
  }
  std::error_code code;
  fs::create_directories(store.parent_path(), code);
  const mode_t former = ::umask(S_IRWXG | S_IRWXO);  // from its first byte on
  Status written = write_file_atomically(store, json_text(tokens, 2) + "\n");
  ::umask(former);
  return written;
}

}  // namespace surfcast::client
