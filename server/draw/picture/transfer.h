#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

namespace surfcast::picture {

/// A point of a transfer function.
struct TransferPoint {
  double value = 0;
  glm::dvec3 color{1};                 ///< sRGB, components from 0 to 1
  double opacity = 0;                  ///< of one spacing, from 0 to 1
  std::optional<double> extinction{};  ///< 1 / world unit, instead of the opacity
  bool operator==(const TransferPoint&) const = default;
};

/// kAuto: chosen by the values of the volume.
enum class TransferPreset { kGray, kCtBone, kCtSoft, kMr, kAuto };
inline constexpr size_t kTransferPresets = 5;

/// How the values of volumes look: points, or a preset. Between points, the colour in linear light and the extinction
/// are linear; beyond the first and the last they stay. Two points of one value are a step.
struct Transfer {
  /// In any order; of several at one value the first and last count, in the order stated.
  std::vector<TransferPoint> points;
  std::optional<double> spacing{};  ///< length to which opacities refer, world units; none: the volume's grid spacing
  TransferPreset preset = TransferPreset::kGray;  ///< without points
  std::optional<double> first{};                  ///< the value at the start of the preset; none: the volume's own
  std::optional<double> last{};                   ///< the value at the end of the preset
};

/// The surface where the field of a volume has a value.
struct IsoSurface {
  double value = 0;
  glm::dvec3 color{231.0 / 255};  ///< sRGB, components from 0 to 1; by default the grey of models without colours
  double opacity = 1;
};

/// A plane through volumes, in the colours of the transfer function without its opacities.
struct Slice {
  glm::dvec3 point{0};        ///< world
  glm::dvec3 normal{0};       ///< world, any length above 0
  std::optional<int> axis{};  ///< 0, 1, 2: where the index along this axis of the grid is `index`, instead of a plane
  double index = 0;
};

/// How volumes are drawn.
struct VolumeOptions {
  Transfer transfer;
  bool shaded = false;             ///< lit by a headlight, by their gradients
  bool medium = true;              ///< what the transfer function shows is drawn
  std::vector<IsoSurface> isos{};  ///< at most 8
  std::vector<Slice> slices{};     ///< at most 8
};

}  // namespace surfcast::picture
