#pragma once

#include <chrono>
#include <functional>
#include <stop_token>

namespace surfcast {

/// Calls `work` after each interval, until a stop is requested, which also ends the wait.
void repeat(const std::stop_token& stop, std::chrono::milliseconds interval, const std::function<void()>& work);

}  // namespace surfcast
