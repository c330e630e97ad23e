#pragma once

#include <cstdint>
#include <string>

#include "base/descriptor.h"
#include "base/result.h"
#include "worker/channel.h"
#include "worker/sandbox.h"
#include "worker/shared_board.h"

namespace surfcast::worker {

// What the processes of all workers have in common.

/// Ends the process at once: nothing of it is of use to anybody, and destructors of a driver that has failed may hang.
[[noreturn]] void end_worker(int code);

/// Leaves it to the server when this process ends, and adopts the memory that both share.
SharedBoard begin_worker(Descriptor memory);

/// The next message of the server; ends with it. Memory that large answers have left goes back to the system when none
/// comes.
Received next_message(Channel& channel);
/// Ends the process if the server has ended.
void answer_server(Channel& channel, const Message& message);

/// From here on, allocations beyond these bytes fail; 0: no limit.
void limit_memory(uint64_t bytes);

/// restrict_files(). Here and below, a restriction that the kernel does not know is said and left out.
Status confine_files(const OpenFiles& files);
/// restrict_calls(), and no process of the same user traces this one.
Status confine_calls();

}  // namespace surfcast::worker
