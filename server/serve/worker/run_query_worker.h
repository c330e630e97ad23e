#pragma once

#include "base/descriptor.h"
#include "kinds/kind_table.h"

namespace surfcast::worker {

/// Answers questions about models for the server at the other end of the socket, one after the other, until that closes
/// the connection. Needs no GL and no device. Does not return: ends the process.
[[noreturn]] void run_query_worker(Descriptor socket, Descriptor memory,
                                   kinds::KindTable kinds = kinds::built_in_kinds());

}  // namespace surfcast::worker
