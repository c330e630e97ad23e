#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace surfcast::net {

// What systemd and a service say to each other (sd_notify(3),
// sd_listen_fds(3)). Without systemd nothing happens.

/// Tells the service manager: "READY=1", "STOPPING=1", "WATCHDOG=1".
void notify_manager(const std::string& state);

/// How often the manager wants a sign of life; nothing: never.
std::optional<std::chrono::microseconds> watchdog_interval();

/// The listening socket that the manager has opened for this process; -1: none.
int inherited_listener();

}  // namespace surfcast::net
