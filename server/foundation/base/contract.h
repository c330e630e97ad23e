#pragma once

namespace surfcast {

/// Reports a broken contract on stderr and aborts.
[[noreturn]] void contract_broken(const char* condition, const char* file, int line);

}  // namespace surfcast

/// States a precondition that the caller guarantees. A false condition is a bug in this program, never bad input; it
/// aborts the process.
#define SURFCAST_EXPECTS(condition) ((condition) ? void() : ::surfcast::contract_broken(#condition, __FILE__, __LINE__))
