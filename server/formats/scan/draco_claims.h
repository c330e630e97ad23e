#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace surfcast::scan {

/// Draco allocates memory for the numbers of points and faces that the file states, before it decodes any of them. This
/// check reads only the stated numbers. True if decoding takes no more memory than is plausible for a file of this
/// size. Also true for bytes that are no Draco file, which the decoder rejects by itself.
bool draco_claims_are_plausible(std::span<const std::byte> bytes);

/// Memory of the decoded points in bytes, as stated by the file; 0 if the file does not state it.
uint64_t draco_decoded_bytes(std::span<const std::byte> bytes);

}  // namespace surfcast::scan
