#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "geometry/clip.h"
#include "kinds/glyph_sight.h"
#include "kinds/pixel_hits.h"
#include "kinds/volume_sight.h"

namespace surfcast::kinds {

/// A position in a picture, and the conditions under which the picture shows an item.
struct PickQuery {
  geometry::CameraFrame frame;
  glm::dvec2 pixel{0};  ///< from the upper left corner; pixel centres are at +0.5
  geometry::Clip clip;
  std::bitset<256> hidden_classes;
  /// What the picture shows of the volumes of the model, by their numbers; null: nothing.
  std::shared_ptr<const std::vector<VolumeSight>> volumes{};
  /// What the picture shows of the sources of ellipsoids, by their numbers; null: all, by default.
  std::shared_ptr<const std::vector<GlyphSight>> glyphs{};
  double reach = 0;    ///< what is drawn of an item may extend so far from its centre although its block says less
  double opacity = 1;  ///< see picture::PictureRequest
  double depth = 0;    ///< in describe(): PickHit::depth of the item
  /// How surfels are seen through, beside `opacity`, see picture::PictureRequest. By class; empty: all are 1.
  std::vector<double> class_opacities{};
  double ghost = 0;
  bool by_file = false;                ///< opacities are those of the scan
  bool transparent = false;            ///< surfels are seen through, and from behind
  std::vector<bool> hidden_members{};  ///< see model::hidden_members

  /// Whether something of what lies in the box may be shown.
  [[nodiscard]] bool may_show(const geometry::Box& box) const { return ghost > 0 || clip.may_show(box); }

  /// Null if nothing is shown.
  [[nodiscard]] const VolumeSight* sight_of(uint32_t volume) const {
    return volumes && volume < volumes->size() ? &(*volumes)[volume] : nullptr;
  }
};

struct PickedValue {
  std::string attribute;
  double value = 0;
};

/// A surfel of the source, or an item of another kind, as stored in the model.
struct PickedSurfel {
  glm::dvec3 position{0};            ///< world; exact for inputs whose coordinates lie on a grid
  glm::dvec3 normal{0};              ///< unit; turned towards the eye if its scan is not oriented
  std::optional<glm::u8vec3> color;  ///< sRGB
  double radius = 0;                 ///< world units
  double distance = 0;               ///< from the eye, world units
  std::vector<PickedValue> values;   ///< all attributes, in the model's order
  double depth = 0;                  ///< camera z of the item in the pixel, world units
  uint64_t number = 0;               ///< items of the leaves before it, in the order of the file
  std::optional<uint32_t> member{};  ///< of a joined model: the one that it is of
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
