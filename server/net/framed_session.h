#pragma once

#include <memory>

#include "net/session.h"

namespace surfcast {

/// A connection of the framed protocol, whose first byte has been seen but not read.
std::shared_ptr<Session> start_framed_session(Connection connection);

}  // namespace surfcast
