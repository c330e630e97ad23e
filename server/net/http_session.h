#pragma once

#include <memory>

#include "net/session.h"

namespace surfcast {

/// A connection that speaks HTTP/1.1. A busy server answers 503 once and closes.
std::shared_ptr<Session> start_http_session(Connection connection);

}  // namespace surfcast
