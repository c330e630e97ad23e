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
#include "kinds/pixel_hits.h"

namespace surfcast::kinds {

/// A position in a picture, and the conditions under which the picture shows an item.
struct PickQuery {
  geometry::CameraFrame frame;
  glm::dvec2 pixel{0};  ///< from the upper left corner; pixel centres are at +0.5
  geometry::Clip clip;
  std::bitset<256> hidden_classes;
};

struct PickedValue {
  std::string attribute;
  double value = 0;
};

/// A surfel of the source, or an item of another kind, as stored in the model.
struct PickedSurfel {
  glm::dvec3 position{0};            ///< world; exact for inputs whose coordinates lie on a grid
  glm::dvec3 normal{0};              ///< unit; turned towards the eye if the model is not oriented
  std::optional<glm::u8vec3> color;  ///< sRGB
  double radius = 0;                 ///< world units
  double distance = 0;               ///< from the eye, world units
  std::vector<PickedValue> values;   ///< all attributes, in the model's order
  double depth = 0;                  ///< camera z of the item in the pixel, world units
  uint64_t number = 0;               ///< items of the leaves before it, in the order of the file
};

/// A decoded block with all attributes in the file.
class SourceBlock {
 public:
  virtual ~SourceBlock() = default;
  /// Size in memory.
  [[nodiscard]] virtual size_t bytes() const = 0;
  /// Appends the items that cover the pixel, except those that are clipped, culled or in a hidden class.
  virtual void hit(const PickQuery& query, std::vector<PickHit>& hits) const = 0;
  /// Adds what hit() finds in each pixel of a rectangle. `query.pixel` has no meaning.
  virtual void cover(const PickQuery& query, PixelHits& pixels) const = 0;
  [[nodiscard]] virtual PickedSurfel describe(const PickQuery& query, uint32_t item) const = 0;
};

}  // namespace surfcast::kinds
