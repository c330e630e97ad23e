#pragma once

#include <cstddef>
#include <cstdint>

namespace surfcast::estimation {

/// Moves the keys up to `last` to the front, in their order; returns how many they are. What follows them is undefined.
/// The processor's 256-bit vectors are used if it has them.
size_t keep_up_to(int32_t last, size_t count, int32_t* keys);

}  // namespace surfcast::estimation
