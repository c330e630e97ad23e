#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "laz/record_layout.h"

namespace surfcast::laz::testing {

/// The bytes of a chunk that holds these records, one at least.
std::vector<std::byte> encode_pointwise(const RecordLayout& layout, std::span<const std::byte> records);
std::vector<std::byte> encode_layered(const RecordLayout& layout, std::span<const std::byte> records,
                                      bool stale_channels);

}  // namespace surfcast::laz::testing
