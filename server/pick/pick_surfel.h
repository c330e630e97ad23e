#pragma once

#include <atomic>
#include <bitset>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "geometry/camera.h"
#include "geometry/clip.h"
#include "model/model_file.h"
#include "pick/source_blocks.h"

namespace surfcast::pick {

/// A position in a picture, and what the picture shows.
struct PickQuery {
  geometry::CameraFrame frame;
  glm::dvec2 pixel{0};  ///< from the upper left corner; a pixel's centre is at +0.5
  geometry::Clip clip;
  std::bitset<256> hidden_classes;
};

struct PickedValue {
  std::string attribute;
  double value = 0;
};

/// A surfel of the source, as the model has it.
struct PickedSurfel {
  glm::dvec3 position{0};            ///< world; exact for inputs on a grid
  glm::dvec3 normal{0};              ///< unit; towards the eye where front and back are not known
  std::optional<glm::u8vec3> color;  ///< sRGB
  double radius = 0;                 ///< world units
  double distance = 0;               ///< from the eye, world units
  std::vector<PickedValue> values;   ///< of every attribute, in the model's order
};

/// The surfel of the finest level that a picture shows at a position: of those whose opaque discs cover it and that are
/// not hidden behind a nearer surface, the one whose centre is nearest, measured in its disc as it is seen. None where
/// the background shows. Looks at the blocks along the ray from the eye on and no farther than it sees. Fails when one
/// is damaged, and with kCancelled soon after `cancelled` becomes true.
Result<std::optional<PickedSurfel>> pick_surfel(const model::ModelFile& model, const PickQuery& query,
                                                SourceBlocks& blocks, const std::atomic<bool>& cancelled);

}  // namespace surfcast::pick
