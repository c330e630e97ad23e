#pragma once

namespace surfcast::client {

/// Turns SIGINT and SIGTERM into a descriptor that becomes readable, so that whoever waits for a server can tell it to
/// give up before the program ends. The signals are blocked from here on; call it before any thread starts.
int interrupt_descriptor();

}  // namespace surfcast::client
