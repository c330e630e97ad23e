#pragma once

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "geometry/box.h"
#include "geometry/camera.h"
#include "selection/visible_depths.h"

namespace surfcast::selection {

/// What a coarse picture of a view shows of each block: by the depths of its pixels, and by its surfels. The box of a
/// block says little where the surface in it is thin: a street behind houses lies in boxes that rise above the roofs.
class Visibility {
 public:
  /// Blocks that were entered; see index_of.
  static constexpr uint32_t kNone = 0xFFFFFFFF;

  /// `frame`: of the picture. `spacing`: of its blocks, pixels.
  Visibility(VisibleDepths depths, const geometry::CameraFrame& frame, double spacing)
      : depths_(std::move(depths)), frame_(frame), spacing_(spacing) {}

  /// Enters a block of the picture. `centre`: of each of its surfels, world units. Of many surfels, some are looked at,
  /// evenly along their order.
  void enter(uint32_t block, size_t surfels, const std::function<glm::dvec3(size_t)>& centre);

  /// The spacing of its blocks in the pixels of another picture from there.
  [[nodiscard]] double spacing_in(const geometry::CameraFrame& frame) const {
    return spacing_ * (frame.eta / frame_.eta);
  }
  /// The index of a block that was entered; kNone of others.
  [[nodiscard]] uint32_t index_of(uint32_t block) const;
  /// The share of a box that the picture shows: of the pixels of the box (VisibleDepths::share_of), or of the surfels
  /// in it, whichever is less. Of a box with few surfels, that of the pixels. `entered`: the index of the block whose
  /// surfels stand for those in the box, or kNone.
  [[nodiscard]] double share_of(const geometry::Box& box, double margin, uint32_t entered) const;

 private:
  enum class Sight : uint8_t { kOutside, kHidden, kSeen };
  struct Sample {
    glm::vec3 from_eye;  ///< world axes and units
    Sight sight;
  };

  [[nodiscard]] Sight sight_of(const glm::dvec3& centre) const;
  [[nodiscard]] double share_of_samples(const std::vector<Sample>& samples, const geometry::Box& box) const;

  VisibleDepths depths_;
  geometry::CameraFrame frame_;
  double spacing_;
  std::vector<std::vector<Sample>> blocks_;
  std::unordered_map<uint32_t, uint32_t> indices_;  ///< of `blocks_`, by number
};

}  // namespace surfcast::selection
