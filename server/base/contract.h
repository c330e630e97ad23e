#pragma once

namespace surfcast {

/// Reports a broken contract on stderr and aborts.
[[noreturn]] void contract_broken(const char* condition, const char* file, int line);

}  // namespace surfcast

/// States what the caller promised. A false condition is a bug in this program, never bad input, and stops it.
#define SURFCAST_EXPECTS(condition) ((condition) ? void() : ::surfcast::contract_broken(#condition, __FILE__, __LINE__))
