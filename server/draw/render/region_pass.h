#pragma once

#include <cstdint>
#include <optional>

#include "base/preemption.h"
#include "base/result.h"
#include "kinds/kind.h"
#include "render/programs.h"
#include "render/region_task.h"
#include "render/splat_buffers.h"

namespace surfcast::render {

/// Where a pass finds what is drawn before it, or leaves what it draws.
enum class Place : uint8_t {
  kNowhere,
  kSurfaces,  ///< `volume.layers`: the surfaces of each pixel, their depths and light (shaders/include/keep_layer.glsl)
  kCodes,     ///< `gaussians.layers`: the same in sRGB codes (shaders/gaussian/keep_layers.glsl)
  kPicture,   ///< `picture`, and `fronts` if its depth is asked for
};

struct PassPlaces {
  Place reads = Place::kNowhere;
  Place writes = Place::kPicture;
};

/// How the kinds that are drawn in one way are drawn beside the others: the passes of the GPU from their blocks to
/// layers or pixels. compose_region.cpp has the table of them. A pass declares what it reads and writes, and knows
/// nothing of the others.
struct RegionPass {
  kinds::DrawnAs draws = kinds::DrawnAs::kSurface;
  /// Whether a region without such blocks needs it.
  bool (*also_needed)(const RegionTask& task) = nullptr;
  /// Where it leaves what it draws if others follow. kPicture: none can follow.
  Place leaves = Place::kPicture;
  /// What it reads then, whether or not there is anything.
  Place adds_to = Place::kNowhere;
  /// It writes the depths of all pixels of the picture. Otherwise they are cleared before.
  bool covers = false;
  /// Draws the blocks of a region. What it reads or writes has room, and is empty if nothing has been drawn there. None
  /// if the lists of its tiles are too long: the region must be drawn in parts.
  Result<std::optional<RegionStats>> (*draw)(const RegionTask& task, const PassPlaces& places, Programs& programs,
                                             SplatBuffers& buffers, const Preemption& preemption) = nullptr;
};

}  // namespace surfcast::render
