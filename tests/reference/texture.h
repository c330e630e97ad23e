#pragma once

#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace surfcast::reference {

/// Colour in linear light of a surface at (u, v) in [0, 1]^2.
using Texture = std::function<glm::dvec3(const glm::dvec2& uv)>;

Texture one_color(const glm::dvec3& color);
/// `columns` x `rows` tiles of two colours.
Texture checker(int columns, int rows, const glm::dvec3& a, const glm::dvec3& b);
/// A few low frequencies per channel, within [0.1, 0.9].
Texture sines();
/// White noise at the corners of `cells` x `cells` squares, interpolated bilinearly.
Texture value_noise(int cells);
/// Two colours, separated by a slanted straight edge through the middle.
Texture step_edge(const glm::dvec3& a, const glm::dvec3& b);

}  // namespace surfcast::reference
