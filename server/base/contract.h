#pragma once

#include <source_location>

namespace surfcast {

/// Reports a broken contract on stderr and aborts.
[[noreturn]] void contract_broken(const char* condition, std::source_location where);

}  // namespace surfcast

/// States what the caller promised. A false condition is a bug in this program, never bad input, and stops it.
#define SURFCAST_EXPECTS(condition) \
  ((condition) ? void() : ::surfcast::contract_broken(#condition, std::source_location::current()))
