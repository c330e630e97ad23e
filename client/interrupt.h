#pragma once

namespace surfcast::client {

/// A descriptor that becomes readable on SIGINT or SIGTERM. A command that waits for a server can then cancel its
/// request before the program ends. Blocks both signals; call it before any thread starts.
int interrupt_descriptor();

}  // namespace surfcast::client
