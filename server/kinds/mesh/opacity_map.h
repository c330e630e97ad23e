#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <optional>
#include <span>

#include "mesh/mesh.h"
#include "mesh/texels.h"

namespace surfcast::mesh {

/// The images of a material, decoded; null where there is none.
struct MaterialImages {
  const Texture* color = nullptr;
  const Texture* opacity = nullptr;  ///< may be `color`

  /// Texels of their texture: along each axis those of the finer image. None without images.
  [[nodiscard]] std::optional<glm::ivec2> size() const;
};

/// The colours of a material with the opacities of its image of opacities, multiplied with their own alpha: a texture
/// of images.size(). An image that is coarser is bilinear, within a chart. None where the colours need no change:
/// without an image of opacities, and where it is that of the colours and means their alpha, which counts once.
[[nodiscard]] std::optional<Texture> join_opacity(const MaterialImages& images, const Material& material,
                                                  std::span<const Patch* const> patches);

}  // namespace surfcast::mesh
