#include "access/authorization.h"

#include <algorithm>

#include <fnmatch.h>

namespace surfcast::access {
namespace {

/// What no file's name contains.
constexpr char kNoName = '/';

bool matches(const std::string& pattern, const std::string& model) {
  return ::fnmatch(pattern.c_str(), model.c_str(), 0) == 0;
}

}  // namespace

std::string AuthorizedModel::served_name() const {
  return allowed_ ? name_ : kNoName + name_;
}

std::string shown_name(const std::string& served_name) {
  return served_name.starts_with(kNoName) ? served_name.substr(1) : served_name;
}

bool Rights::may_know(const std::string& model) const {
  if (unlimited_) return true;
  return user_ && std::ranges::any_of(user_->models, [&](const auto& pattern) { return matches(pattern, model); });
}

AuthorizedModel Rights::authorize(std::string model) const {
  const bool allowed = may_know(model);
  return {std::move(model), allowed};
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
