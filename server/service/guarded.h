#pragma once

#include <exception>
#include <string>

#include "base/result.h"

namespace surfcast::service {

/// Runs a function and returns exceptions (out of memory in a library) as errors, so one job cannot terminate the
/// server.
template <typename Function>
auto guarded(Function function) -> decltype(function()) {
  try {
    return function();
  } catch (const std::exception& error) {
    return fail(ErrorKind::kInternal, std::string("unexpected: ") + error.what());
  }
}

}  // namespace surfcast::service
