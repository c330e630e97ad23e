#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace surfcast::scan {

/// Decompresses LZF data (the format of Lehmann's LibLZF). None if the data is damaged or does not expand to exactly
/// `size` bytes. Memory is allocated only if the compressed bytes can expand to that size.
std::optional<std::vector<uint8_t>> decompress_lzf(std::span<const std::byte> compressed, size_t size);

}  // namespace surfcast::scan
