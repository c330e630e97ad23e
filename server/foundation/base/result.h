#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace surfcast {

/// Why an operation failed. The kind decides how a caller reports it (exit code, protocol error). The message is one
/// line for a person and names the file or the request concerned.
enum class ErrorKind {
  kInvalidInput,  ///< a file or request whose content is wrong
  kUnsupported,   ///< well formed, but of a kind that is not supported
  kNotFound,      ///< no file or model of this name
  kIo,            ///< the operating system refused: permission, disk full, broken pipe
  kLimit,         ///< larger than a stated limit
  kCancelled,     ///< no longer wanted
  kUnavailable,   ///< a resource is missing (no GL device) or busy
  kReplaced,      ///< a model has been replaced by another one since it was opened
  kInternal,      ///< a bug in this program
};

struct Error {
  ErrorKind kind = ErrorKind::kInternal;
  std::string message;
};

/// A value, or the error why there is none. Expected failures are values; broken contracts abort (see contract.h).
template <typename T>
using Result = tl::expected<T, Error>;

using Status = Result<void>;

[[nodiscard]] inline tl::unexpected<Error> fail(ErrorKind kind, std::string message) {
  return tl::unexpected<Error>(Error{kind, std::move(message)});
}

[[nodiscard]] inline tl::unexpected<Error> fail(Error error) {
  return tl::unexpected<Error>(std::move(error));
}

/// Passes on the error of a result that has no value.
template <typename T>
[[nodiscard]] tl::unexpected<Error> fail(const Result<T>& failed) {
  return tl::unexpected<Error>(failed.error());
}

/// An error whose message begins with its subject, a file for example: "SUBJECT: MESSAGE".
[[nodiscard]] inline tl::unexpected<Error> fail_about(const std::string& subject, const Error& error) {
  return fail(error.kind, subject + ": " + error.message);
}

template <typename T>
[[nodiscard]] tl::unexpected<Error> fail_about(const std::string& subject, const Result<T>& failed) {
  return fail_about(subject, failed.error());
}

}  // namespace surfcast
