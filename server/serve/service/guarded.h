#pragma once

#include <exception>
#include <string>
#include <utility>

#include "base/log.h"
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

/// Calls back with a result, and with an error if there is no memory for what the callback makes of it.
template <typename Done, typename Value>
void deliver(const Done& done, Result<Value> result) try {
  done(std::move(result));
} catch (const std::exception& error) {
  const auto refuse = [&]() -> Status {
    done(fail(ErrorKind::kInternal, std::string("unexpected: ") + error.what()));
    return {};
  };
  if (const Status refused = guarded(refuse); !refused) spdlog::error("an answer is lost: {}", refused.error().message);
}

}  // namespace surfcast::service
