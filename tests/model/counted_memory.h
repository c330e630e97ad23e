#pragma once

#include <cstddef>

namespace surfcast::model {

/// Bytes that `new` has given out and not got back. Programs that link counted_memory.cpp count them.
size_t bytes_in_use();
/// The most there have been at once since `start_peak`.
size_t peak_bytes_in_use();
void start_peak();

}  // namespace surfcast::model
