#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "access/secret.h"
#include "access/token_file.h"
#include "base/ascii_text.h"
#include "cmd/commands.h"
#include "protocol/parse.h"
#include "protocol/request_flags.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;
using access::Principal;

struct TokenCommand {
  std::string action;
  fs::path file;
  Principal principal;
  std::string expires;
};

/// The tokens of a file; none if it is not there yet.
Result<std::vector<Principal>> tokens_of(const fs::path& file) {
  std::error_code code;
  if (!fs::exists(file, code)) return std::vector<Principal>();
  return access::read_tokens(file);
}

/// "90d", "12h", or a time as in the file.
Result<Principal::Time> parse_expiry(const std::string& text) {
  using std::chrono::hours;
  constexpr std::array<std::pair<char, hours>, 2> kUnits{{{'d', hours(24)}, {'h', hours(1)}}};
  for (const auto& [letter, unit] : kUnits) {
    if (!text.ends_with(letter)) continue;
    const std::optional<uint32_t> count = protocol::parse_unsigned(text.substr(0, text.size() - 1));
    if (count) return std::chrono::system_clock::now() + *count * unit;
  }
  return access::parse_time(text);
}

Status add_token(TokenCommand command) {
  Result<std::vector<Principal>> tokens = tokens_of(command.file);
  if (!tokens) return fail(tokens);
  if (std::ranges::find(*tokens, command.principal.name, &Principal::name) != tokens->end()) {
    return fail(ErrorKind::kInvalidInput,
                command.file.string() + ": there is a token '" + command.principal.name + "' already");
  }
  const std::string secret = access::make_secret();
  command.principal.sha256 = access::sha256(secret);
  tokens->push_back(std::move(command.principal));
  if (Status status = access::write_tokens(command.file, *tokens); !status) return status;
  std::cout << secret << '\n';
  if (!std::cout.flush()) return fail(ErrorKind::kIo, "cannot write to standard output");
  return {};
}

Status list_tokens(const fs::path& file) {
  const auto tokens = access::read_tokens(file);
  if (!tokens) return fail(tokens);
  const auto now = std::chrono::system_clock::now();
  for (const Principal& token : *tokens) {
    std::cout << token.name << '\t' << (token.models.empty() ? "-" : joined(token.models, ",")) << '\t'
              << (token.expires ? access::time_text(*token.expires) : "never")
              << (access::has_expired(token, now) ? " (expired)" : "") << '\n';
  }
  if (!std::cout.flush()) return fail(ErrorKind::kIo, "cannot write to standard output");
  return {};
}

Status revoke_token(const fs::path& file, const std::string& name) {
  auto tokens = access::read_tokens(file);
  if (!tokens) return fail(tokens);
  if (std::erase_if(*tokens, [&](const Principal& token) { return token.name == name; }) == 0) {
    return fail(ErrorKind::kNotFound, file.string() + ": there is no token '" + name + "'");
  }
  return access::write_tokens(file, *tokens);
}

/// Sets when the token ends.
void set_expiry(TokenCommand& command) {
  if (command.expires.empty()) return;
  const auto expires = parse_expiry(command.expires);
  if (!expires) throw CLI::ValidationError("--expires", expires.error().message);
  command.principal.expires = *expires;
}

Status run(TokenCommand command) {
  if (command.action == "list") return list_tokens(command.file);
  if (command.principal.name.empty()) throw CLI::RequiredError("NAME");
  if (command.action == "revoke") return revoke_token(command.file, command.principal.name);
  set_expiry(command);
  return add_token(std::move(command));
}

}  // namespace

void add_token_command(CLI::App& app, Status& outcome) {
  const auto command = std::make_shared<TokenCommand>();
  Principal& principal = command->principal;
  CLI::App* sub = app.add_subcommand("token", "Make, list and revoke the tokens of serve --tokens");
  sub->add_option("ACTION", command->action,
                  "add: make a token and print its secret, which is shown this once; list: print name, models and end "
                  "of each; revoke: remove one, and what is open with it ends within seconds")
      ->required()
      ->check(CLI::IsMember({"add", "list", "revoke"}));
  sub->add_option("NAME", principal.name, "Whose token is added or revoked");
  sub->add_option("--tokens", command->file, "The file of tokens")
      ->required()
      ->envname(protocol::environment_name("tokens"))
      ->type_name("FILE");
  sub->add_option("--models", principal.models,
                  "Of add: names of models that it opens, with *, ? and [...]; may be repeated (default: none)")
      ->allow_extra_args(false);
  sub->add_option("--expires", command->expires,
                  "Of add: when it ends, 90d, 12h or 2027-01-31T12:00:00Z (default: never)");
  sub->add_option("--token-connections", principal.connections,
                  "Of add: connections at a time (default: no limit of its own)");
  sub->add_option("--token-views", principal.views, "Of add: views at a time (default: no limit of its own)");
  sub->add_flag("--allow-uploads", principal.uploads, "Of add: it may send scans, under names that --models allows");
  sub->add_flag("--allow-annotations", principal.annotations,
                "Of add: it may write saved views and annotations of the models that it opens");
  sub->callback([command, &outcome] { outcome = run(*command); });
}

}  // namespace surfcast::cmd
