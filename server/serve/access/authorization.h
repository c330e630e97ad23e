#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "access/principal.h"

namespace surfcast::access {

/// A model that somebody asks for, and whether they may know of it. Rights alone makes one: whoever takes it as an
/// argument cannot be called without that decision. One that is not allowed is asked for all the same, under a name
/// that no model has, so that the answer is that for a model that is absent, and comes of the same work. A name such as
/// "a+b" is that of one model, or of several that are shown together: these are two decisions.
class AuthorizedModel {
 public:
  /// As it was asked for.
  [[nodiscard]] const std::string& name() const { return name_; }
  /// The model of exactly this name, or the models that it joins.
  [[nodiscard]] bool allowed() const { return alone_ || joined_; }
  /// The model of exactly this name.
  [[nodiscard]] bool allowed_alone() const { return alone_; }
  /// Under which it is looked up.
  [[nodiscard]] std::string served_name() const;

 private:
  friend class Rights;
  AuthorizedModel(std::string name, bool alone, bool joined) : name_(std::move(name)), alone_(alone), joined_(joined) {}

  std::string name_;
  bool alone_;
  bool joined_;  ///< it joins models, and each of them is allowed
};

/// What a served name stands for.
struct ServedName {
  std::string name;    ///< as it was asked for: errors write this
  bool alone = true;   ///< the model of exactly this name may be the answer
  bool joined = true;  ///< otherwise those that it joins
};
[[nodiscard]] ServedName parse_served_name(const std::string& served_name);

/// As errors write a name that was looked up: that which was asked for.
std::string shown_name(const std::string& served_name);

/// A model whose saved views and annotations somebody may write.
class AuthorizedAnnotations {
 public:
  [[nodiscard]] const AuthorizedModel& model() const { return model_; }

 private:
  friend class Rights;
  explicit AuthorizedAnnotations(AuthorizedModel model) : model_(std::move(model)) {}

  AuthorizedModel model_;
};

/// A scan that somebody may send.
class AuthorizedUpload {
 public:
  /// Its name.
  [[nodiscard]] const std::string& file() const { return file_; }
  /// The name of their token; empty: none is needed.
  [[nodiscard]] const std::string& sender() const { return sender_; }

 private:
  friend class Rights;
  AuthorizedUpload(std::string file, std::string sender) : file_(std::move(file)), sender_(std::move(sender)) {}

  std::string file_;
  std::string sender_;
};

/// What somebody may do with models: the one place where that is decided.
class Rights {
 public:
  /// Of everybody where no tokens are wanted, and of whoever runs a program on files of their own.
  static Rights unlimited() { return Rights(nullptr, true); }
  /// Of whoever has named a token; null: of nobody, who may do nothing.
  static Rights of(std::shared_ptr<const Principal> user) { return Rights(std::move(user), false); }

  [[nodiscard]] AuthorizedModel authorize(std::string model) const;
  /// Nothing: they may not.
  [[nodiscard]] std::optional<AuthorizedAnnotations> authorize_annotations(std::string model) const;
  /// Likewise. `model`: the name that the model of the file would have.
  [[nodiscard]] std::optional<AuthorizedUpload> authorize_upload(std::string file, const std::string& model) const;

 private:
  Rights(std::shared_ptr<const Principal> user, bool unlimited) : user_(std::move(user)), unlimited_(unlimited) {}
  [[nodiscard]] bool may_know(const std::string& model) const;

  std::shared_ptr<const Principal> user_;
  bool unlimited_;
};

}  // namespace surfcast::access
