#include "access/token_file.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>
#include <utility>

#include "base/atomic_file.h"
#include "base/json_text.h"

namespace surfcast::access {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kTimeForm = "%Y-%m-%dT%H:%M:%SZ";
constexpr size_t kHashDigits = 64;

/// Throws what nlohmann::json throws where a value is of another type than wanted.
Result<Principal> to_principal(const json& entry) {
  Principal principal;
  principal.name = entry.at("name").get<std::string>();
  principal.sha256 = entry.at("sha256").get<std::string>();
  std::ranges::transform(principal.sha256, principal.sha256.begin(),
                         [](char c) { return c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c; });
  principal.models = entry.value("models", std::vector<std::string>());
  principal.connections = entry.value("connections", size_t{0});
  principal.views = entry.value("views", size_t{0});
  principal.uploads = entry.value("uploads", false);
  principal.annotations = entry.value("annotations", false);
  const bool hash = principal.sha256.size() == kHashDigits &&
                    principal.sha256.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (principal.name.empty() || !hash) return fail(ErrorKind::kInvalidInput, "a token has a name and a sha256");
  if (!entry.contains("expires")) return principal;
  return parse_time(entry.at("expires").get<std::string>()).map([&](Principal::Time time) {
    principal.expires = time;
    return principal;
  });
}

json to_json(const Principal& principal) {
  json entry{{"name", principal.name}, {"sha256", principal.sha256}, {"models", principal.models}};
  if (principal.expires) entry["expires"] = time_text(*principal.expires);
  if (principal.connections > 0) entry["connections"] = principal.connections;
  if (principal.views > 0) entry["views"] = principal.views;
  if (principal.uploads) entry["uploads"] = true;
  if (principal.annotations) entry["annotations"] = true;
  return entry;
}

Result<std::vector<Principal>> to_principals(const json& document) {
  std::vector<Principal> principals;
  std::set<std::string> names;
  for (const json& entry : document.at("tokens")) {
    Result<Principal> principal = to_principal(entry);
    if (!principal) return fail(principal);
    if (!names.insert(principal->name).second) {
      return fail(ErrorKind::kInvalidInput, "two tokens are named '" + principal->name + "'");
    }
    principals.push_back(std::move(*principal));
  }
  return principals;
}

}  // namespace

Result<std::vector<Principal>> read_tokens(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) return fail(ErrorKind::kIo, file.string() + ": cannot be read");
  try {
    auto principals = to_principals(parse_json_text(std::string(std::istreambuf_iterator<char>(stream), {})));
    if (principals) return principals;
    return fail_about(file.string(), principals);
  } catch (const json::exception&) {
    return fail(ErrorKind::kInvalidInput, file.string() + ": not a file of tokens");
  }
}

Status write_tokens(const fs::path& file, const std::vector<Principal>& tokens) {
  json entries = json::array();
  for (const Principal& token : tokens) entries.push_back(to_json(token));
  std::error_code code;
  const fs::file_status former = fs::status(file, code);
  const fs::perms mode = fs::exists(former) ? former.permissions() : fs::perms::owner_read | fs::perms::owner_write;
  const std::string text = json_text(json{{"tokens", entries}}, 2) + "\n";
  if (Status status = write_file_atomically(file, text); !status) return status;
  fs::permissions(file, mode, code);
  if (code) return fail(ErrorKind::kIo, file.string() + ": its mode cannot be set: " + code.message());
  return {};
}

std::string time_text(Principal::Time time) {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(time);
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  return {text.data(), std::strftime(text.data(), text.size(), kTimeForm, &parts)};
}

Result<Principal::Time> parse_time(std::string_view text) {
  const std::string copy(text);
  std::tm parts{};
  const char* const end = ::strptime(copy.c_str(), kTimeForm, &parts);
  if (end == nullptr || *end != '\0') {
    return fail(ErrorKind::kInvalidInput, "'" + copy + "': expected a time like 2027-01-31T12:00:00Z");
  }
  return std::chrono::system_clock::from_time_t(::timegm(&parts));
}

}  // namespace surfcast::access
