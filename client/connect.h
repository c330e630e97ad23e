#pragma once

#include <chrono>

#include "base/result.h"
#include "protocol/endpoint.h"

namespace surfcast::client {

/// A connected, non-blocking TCP socket. Tries each address of the host name in turn.
Result<int> connect_to(const protocol::Endpoint& server, std::chrono::steady_clock::time_point deadline, int interrupt);

/// Waits until a descriptor is ready for `events`, as in poll(2). kCancelled when `interrupt` becomes readable (-1:
/// none), kUnavailable at the deadline.
Status wait_for(int descriptor, short events, std::chrono::steady_clock::time_point deadline, int interrupt);

}  // namespace surfcast::client
