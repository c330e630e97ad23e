#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace surfcast::scan {

/// Draco reserves memory for as many points and faces as a file claims to have before it decodes them. This looks at
/// the claims alone: whether decoding takes no more memory than a file of that many bytes warrants. True as well for
/// bytes that are no Draco file, which the decoder refuses by itself.
bool draco_claims_are_plausible(std::span<const std::byte> bytes);

/// Bytes of memory that the points take once they are decoded, as far as a file says so; 0 if it does not.
uint64_t draco_decoded_bytes(std::span<const std::byte> bytes);

}  // namespace surfcast::scan
