#pragma once

#include "base/descriptor.h"
#include "kinds/kind_table.h"

namespace surfcast::worker {

/// The exit code of a worker whose GPU was reset.
inline constexpr int kGpuWasReset = 3;

/// The descriptors that a worker is started with.
inline constexpr int kWorkerSocket = 3;
inline constexpr int kWorkerMemory = 4;

/// Draws pictures for the server at the other end of the socket, until that closes the connection. Does not return:
/// ends the process.
[[noreturn]] void run_worker(Descriptor socket, Descriptor memory, kinds::KindTable kinds = kinds::built_in_kinds());

/// Answers questions about models for the server at the other end of the socket, one after the other, until that closes
/// the connection. Needs no GL and no device. Does not return: ends the process.
[[noreturn]] void run_query_worker(Descriptor socket, Descriptor memory,
                                   kinds::KindTable kinds = kinds::built_in_kinds());

}  // namespace surfcast::worker
