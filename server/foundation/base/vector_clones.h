#pragma once

/// Before a function: compiles it for processors with 256-bit vectors as well. The program chooses when it starts.
/// Results are the same to the bit: AVX2 without FMA does not contract products and sums. For short loops over arrays
/// of floats and integers; such a function is never inlined. Sanitizers do not support the choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define SURFCAST_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define SURFCAST_VECTOR_CLONES
#endif
