#pragma once

#include <cstddef>

namespace surfcast::model {

/// Bytes allocated with `new` and not yet freed. Counted in programs that link counted_memory.cpp.
size_t bytes_in_use();
/// The maximum of bytes_in_use() since `start_peak`.
size_t peak_bytes_in_use();
void start_peak();

}  // namespace surfcast::model
