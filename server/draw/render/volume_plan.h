#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "geometry/clip.h"
#include "kinds/brick_block.h"
#include "picture/picture.h"
#include "render/region.h"
#include "render/transfer_function.h"
#include "residency/block_pool.h"
#include "shared/volume_layout.h"

namespace surfcast::render {

/// A resident brick.
struct VisibleBrick {
  const kinds::BrickBlock* block = nullptr;
  std::span<const uint32_t> pages;  ///< see ResidentBlock
};

/// What the pass over one volume reads.
struct VolumePlan {
  layout::VolumeConstants constants{};
  std::vector<layout::BrickView> bricks;
  std::vector<uint32_t> cells;  ///< see SURFCAST_UNIT_CELLS
  std::vector<uint32_t> seen;   ///< see SURFCAST_UNIT_SEEN
  std::vector<uint32_t> pages;  ///< see SURFCAST_UNIT_PAGES
  std::vector<layout::VolumeClip> clips;
  std::vector<glm::uvec4> transfer;  ///< see TransferTable::sums
  layout::VolumeSurfaces surfaces{};
  std::vector<glm::vec4> ramp;  ///< see SURFCAST_UNIT_RAMP; for slices only
};

/// How volumes are drawn in one picture.
struct VolumeLook {
  std::vector<picture::TransferPoint> points;
  geometry::Clip clip;
  std::optional<double> spacing{};  ///< see Transfer::spacing
  double step = 1;                  ///< between places on a ray, in samples of a brick's level
  bool medium = true;               ///< what the transfer function shows is drawn
  double opacity = 1;               ///< see PictureRequest::opacity
  bool unlit = false;               ///< iso-surfaces are not lit
  std::vector<picture::IsoSurface> isos{};
  std::vector<picture::Slice> slices{};

  /// The transfer function as it is drawn: transparent without the medium. `grid_spacing`: world units.
  [[nodiscard]] TransferFunction medium_function(double grid_spacing) const;
};

/// How the volumes of a picture are drawn; without points if it names a preset.
VolumeLook look_of(const picture::PictureRequest& request);

/// The world's part of a volume: from the first to the last sample along every axis.
struct VolumePlace {
  glm::u32vec3 size{1};
  glm::dmat4x3 index_to_world{1.0};

  [[nodiscard]] glm::dmat3 axes() const;  ///< steps along i, j and k
  /// The distance to which opacities refer: the edge of a cube with the volume of a cell, world units.
  [[nodiscard]] double spacing() const;
};

/// Plans the drawing of the bricks of one volume, at least one, into the light of a region. The plan is the same for
/// every order of the bricks.
VolumePlan plan_volume(std::span<const VisibleBrick> bricks, const VolumeLook& look, const geometry::CameraFrame& frame,
                       const Region& region);

}  // namespace surfcast::render
