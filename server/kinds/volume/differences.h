#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace surfcast::volume {

/// How many axes differences are taken along, from i on; 0: none. Smooth fields are smallest with 3, noise with 0 or 1.
inline constexpr uint32_t kDifferenceAxes = 3;

/// Replaces codes (i fastest, then j, then k) by differences modulo 2^16 along the first `axes` axes, mapped so that
/// small differences of both signs are small numbers. The first codes of rows are differences along the next axes.
void take_differences(std::span<uint16_t> codes, const glm::u32vec3& size, uint32_t axes);
/// The inverse of take_differences.
void sum_differences(std::span<uint16_t> codes, const glm::u32vec3& size, uint32_t axes);

}  // namespace surfcast::volume
