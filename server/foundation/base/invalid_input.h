#pragma once

#include <string>
#include <utility>

#include "base/result.h"

namespace surfcast {

/// The error of a reader that finds `what` in its input.
[[nodiscard]] inline tl::unexpected<Error> invalid_input(std::string what) {
  return fail(ErrorKind::kInvalidInput, std::move(what));
}

}  // namespace surfcast
