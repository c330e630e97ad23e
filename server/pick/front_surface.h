#pragma once

#include <atomic>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "base/result.h"
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

/// What pick_surfel() finds in every pixel of a picture, in rows from top to bottom. `query.pixel` has no meaning. Each
/// leaf in view is decoded once or a few times, from the eye on, unless nearer ones hide it. Takes about 100 bytes for
/// each of at most a million pixels, and 32 for each pixel of the picture. Fails as pick_surfel().
Result<std::vector<FrontPixel>> find_front_surface(const model::ModelFile& model, const kinds::PickQuery& query,
                                                   SourceBlocks& blocks, const std::atomic<bool>& cancelled);

}  // namespace surfcast::pick
