#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace surfcast::scan {

/// Undoes LZF compression (the format of Lehmann's LibLZF). Nothing when the data is damaged or does not expand to
/// exactly `size` bytes; memory is reserved only for sizes that so many compressed bytes can expand to.
std::optional<std::vector<uint8_t>> decompress_lzf(std::span<const std::byte> compressed, size_t size);

}  // namespace surfcast::scan
