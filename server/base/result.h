#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace surfcast {

/// Why an operation could not be done. The kind decides how a caller answers (exit code, protocol error); the message
/// is one line for a person and names the file or the request it is about.
enum class ErrorKind {
  kInvalidInput,  ///< a file or request whose content is wrong
  kUnsupported,   ///< well formed, but of a kind that is not handled
  kNotFound,      ///< no file or model of that name
  kIo,            ///< the operating system refused: permission, disk full, broken pipe
  kLimit,         ///< larger than a stated limit
  kCancelled,     ///< no longer wanted
  kUnavailable,   ///< a resource is missing (no GL device) or busy
  kInternal,      ///< our own fault
};

struct Error {
  ErrorKind kind = ErrorKind::kInternal;
  std::string message;
};

/// A value, or the reason there is none. Expected failures travel as values; broken contracts stop (see contract.h).
template <typename T>
using Result = tl::expected<T, Error>;

using Status = Result<void>;

[[nodiscard]] inline tl::unexpected<Error> fail(ErrorKind kind, std::string message) {
  return tl::unexpected<Error>(Error{kind, std::move(message)});
}

[[nodiscard]] inline tl::unexpected<Error> fail(Error error) {
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace surfcast
