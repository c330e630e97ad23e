#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <tuple>
#include <vector>

namespace surfcast::kinds {

/// An item of a block that covers a pixel.
struct PickHit {
  uint32_t item = 0;
  double form = 0;      ///< squared distance from the item's centre on the screen, scaled to 1 at its rim
  double depth = 0;     ///< camera z of the item in this pixel
  double occluder = 0;  ///< camera z behind which the item hides everything
  double opacity = 1;   ///< of a translucent item: less than 1, and it hides only what is behind it in part
};

/// The place of an item among those that cover a pixel: the lesser one is picked. Blocks and items decide between equal
/// forms, so that the order of the search does not matter.
struct PickRank {
  double form = 0;
  uint32_t block = 0;
  uint32_t item = 0;

  friend bool operator<(const PickRank& a, const PickRank& b) {
    return std::tie(a.form, a.block, a.item) < std::tie(b.form, b.block, b.item);
  }
};

/// ItemLook::code of models without classes.
inline constexpr float kNoClass = -1;

/// The share of the light that a ray loses up to the translucent item that it sees.
inline constexpr double kSeenThrough = 0.5;

/// What a picture can show of an item beside its colour.
struct ItemLook {
  glm::vec3 normal{0};    ///< world, unit; turned towards the eye if its scan is not oriented
  float code = kNoClass;  ///< classification
};

/// A rectangle of pixels: the first and the last, inclusive.
struct PixelRange {
  glm::ivec2 first{0};
  glm::ivec2 last{-1};

  [[nodiscard]] bool empty() const { return last.x < first.x || last.y < first.y; }
  [[nodiscard]] glm::ivec2 size() const { return last - first + 1; }
};

/// An item that a pixel shows.
struct ShownItem {
  PickRank rank;
  double depth = 0;  ///< camera z
  ItemLook look;
};

/// The items that cover the pixels of a rectangle, collected block by block in any order. Afterwards each pixel knows
/// the item that a pick there would find: the nearest one up to which translucent items leave half of the light, or
/// else the opaque one of the least rank. Of the hits only those are kept that may still be found: of two items the one
/// that is farther and ranks behind never is. So memory grows with the pixels and hardly with the items.
class PixelHits {
 public:
  explicit PixelHits(const PixelRange& range);

  [[nodiscard]] const PixelRange& range() const { return range_; }
  /// The following hits are on items of this block.
  void begin_block(uint32_t block) { block_ = block; }
  /// Calls `visit(pixel)` for the pixels of `range`, which is part of the rectangle, that may show an item whose depth
  /// is at least `nearest` everywhere.
  template <typename Visit>
  void for_each_shown(const PixelRange& range, double nearest, const Visit& visit) const {
    for (int y = range.first.y; y <= range.last.y; ++y) {
      for (int x = range.first.x; x <= range.last.x; ++x) {
        if (nearest <= pixels_[index_of({x, y})].occluder) visit(glm::ivec2(x, y));
      }
    }
  }
  /// True if some pixel of `range` may show an item at the depth `nearest`.
  [[nodiscard]] bool may_show(const PixelRange& range, double nearest) const;
  void add(const glm::ivec2& pixel, const PickHit& hit, const ItemLook& look);
  /// None: the background.
  [[nodiscard]] std::optional<ShownItem> shown(const glm::ivec2& pixel) const;

 private:
  static constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
  /// The items of a pixel form a list in ascending depth and descending rank.
  struct Entry {
    ShownItem item;
    uint32_t next = kNone;
    double opacity = 1;
  };
  struct Pixel {
    double occluder = std::numeric_limits<double>::infinity();
    uint32_t nearest = kNone;
    uint32_t translucent = kNone;  ///< list of translucent items in ascending depth
  };

  [[nodiscard]] size_t index_of(const glm::ivec2& pixel) const {
    const glm::ivec2 at = pixel - range_.first;
    return static_cast<size_t>(at.y) * static_cast<size_t>(range_.size().x) + static_cast<size_t>(at.x);
  }
  uint32_t store(const Entry& entry);
  void drop_from(uint32_t& link);
  void drop_hidden(Pixel& pixel);
  void add_translucent(Pixel& pixel, const PickHit& hit, const ItemLook& look);

  PixelRange range_;
  uint32_t block_ = 0;
  std::vector<Pixel> pixels_;
  std::vector<Entry> entries_;
  uint32_t free_ = kNone;  ///< list of entries without an item
};

}  // namespace surfcast::kinds
