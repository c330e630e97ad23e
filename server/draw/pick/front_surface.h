#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "base/result.h"
#include "kinds/pixel_hits.h"
#include "kinds/source_block.h"
#include "model/model_file.h"
#include "pick/source_blocks.h"

namespace surfcast::pick {

/// What pick_surfel() finds in a pixel.
struct FrontPixel {
  static constexpr uint64_t kBackground = std::numeric_limits<uint64_t>::max();

  double depth = std::numeric_limits<double>::infinity();  ///< camera z, world units; infinite: the background
  uint64_t number = kBackground;                           ///< PickedSurfel::number
  glm::vec3 normal{0};                                     ///< as PickedSurfel::normal
  float code = kinds::kNoClass;                            ///< classification; kNoClass: none
};

/// A rectangle of a picture that is searched at once, at most 1024 pixels a side.
using SurfaceRegion = kinds::PixelRange;

/// The regions of a picture, row by row.
std::vector<SurfaceRegion> surface_regions(int width, int height);

/// Called with the pixels of a region, in rows from top to bottom. An error ends the search.
using RegionDone = std::function<Status(const SurfaceRegion& region, std::span<const FrontPixel> pixels)>;

/// What pick_surfel() finds in every pixel of a picture, in the order of surface_regions(). `query.pixel` has no
/// meaning. Each leaf in view is decoded once or a few times, from the eye on, unless nearer ones hide it. Takes about
/// 130 bytes for each of at most a million pixels. Fails as pick_surfel().
Status search_front_surface(const model::ModelFile& model, const kinds::PickQuery& query, SourceBlocks& blocks,
                            const std::atomic<bool>& cancelled, const RegionDone& done);

/// The same for the whole picture, in rows from top to bottom: 32 bytes more for each of its pixels.
Result<std::vector<FrontPixel>> find_front_surface(const model::ModelFile& model, const kinds::PickQuery& query,
                                                   SourceBlocks& blocks, const std::atomic<bool>& cancelled);

/// Copies the pixels of a region to their places in a picture of this width.
void place_region(const SurfaceRegion& region, std::span<const FrontPixel> pixels, int width,
                  std::vector<FrontPixel>& picture);

}  // namespace surfcast::pick
