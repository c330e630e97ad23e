#include "access/authorization.h"

#include <algorithm>

#include <fnmatch.h>

#include "access/joined_name.h"

namespace surfcast::access {
namespace {

/// What no file's name contains. A served name that begins with it goes on with one of the letters below, and then with
/// the name that was asked for. Any other may be that of one model as well as of those that it joins.
constexpr char kNoName = '/';
constexpr char kNothing = '0';
constexpr char kAlone = '1';
constexpr char kJoined = '2';

bool matches(const std::string& pattern, const std::string& model) {
  return ::fnmatch(pattern.c_str(), model.c_str(), 0) == 0;
}

}  // namespace

std::string AuthorizedModel::served_name() const {
  if (alone_ && (joined_ || members_of(name_).empty())) return name_;
  const char right = alone_ ? kAlone : joined_ ? kJoined : kNothing;
  return std::string{kNoName, right} + name_;
}

ServedName parse_served_name(const std::string& served_name) {
  if (!served_name.starts_with(kNoName) || served_name.size() < 2) return {served_name};
  return {served_name.substr(2), served_name[1] == kAlone, served_name[1] == kJoined};
}

std::string shown_name(const std::string& served_name) {
  return parse_served_name(served_name).name;
}

/// No model has a name with a mark: who asks for one asks for nothing that a served name may stand for.
bool Rights::may_know(const std::string& model) const {
  if (model.find(kNoName) != std::string::npos) return false;
  if (unlimited_) return true;
  return user_ && std::ranges::any_of(user_->models, [&](const auto& pattern) { return matches(pattern, model); });
}

AuthorizedModel Rights::authorize(std::string model) const {
  const std::vector<std::string> members = members_of(model);
  const bool joined =
      !members.empty() && std::ranges::all_of(members, [this](const std::string& member) { return may_know(member); });
  const bool alone = may_know(model);
  return {std::move(model), alone, joined};
}

std::optional<AuthorizedAnnotations> Rights::authorize_annotations(std::string model) const {
  AuthorizedModel known = authorize(std::move(model));
  if (!known.allowed() || !(unlimited_ || user_->annotations)) return std::nullopt;
  return AuthorizedAnnotations(std::move(known));
}

std::optional<AuthorizedUpload> Rights::authorize_upload(std::string file, const std::string& model) const {
  if (!may_know(model) || !(unlimited_ || user_->uploads)) return std::nullopt;
  return AuthorizedUpload(std::move(file), unlimited_ ? std::string() : user_->name);
}

}  // namespace surfcast::access
