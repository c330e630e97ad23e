#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "geometry/clip.h"

namespace surfcast::kinds {

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

/// A surfel of the source, or an item of another kind, as the model has it.
struct PickedSurfel {
  glm::dvec3 position{0};            ///< world; exact for inputs on a grid
  glm::dvec3 normal{0};              ///< unit; towards the eye where front and back are not known
  std::optional<glm::u8vec3> color;  ///< sRGB
  double radius = 0;                 ///< world units
  double distance = 0;               ///< from the eye, world units
  std::vector<PickedValue> values;   ///< of every attribute, in the model's order
};

/// An item of a block that covers a pixel.
struct PickHit {
  uint32_t item = 0;
  double form = 0;      ///< squared distance from the item's middle as it is seen, 1 at its rim
  double depth = 0;     ///< camera z at which the item is seen
  double occluder = 0;  ///< camera z behind which the item hides everything
};

/// A decoded block with all that the file says of its items.
class SourceBlock {
 public:
  virtual ~SourceBlock() = default;
  /// Of memory.
  [[nodiscard]] virtual size_t bytes() const = 0;
  /// Appends the items that cover the pixel and that the picture shows.
  virtual void hit(const PickQuery& query, std::vector<PickHit>& hits) const = 0;
  [[nodiscard]] virtual PickedSurfel describe(const PickQuery& query, uint32_t item) const = 0;
};

}  // namespace surfcast::kinds
