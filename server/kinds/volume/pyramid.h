#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "base/result.h"
#include "volume/brick.h"

namespace surfcast::volume {

/// Makes the levels of a volume while its planes arrive, k = 0 first. Of each level it holds as many planes as a row of
/// bricks with its halo takes. `Sample` is float or double.
template <typename Sample>
class Pyramid {
 public:
  /// Called when the planes of the bricks (*, *, k) of a level are complete, in this order: all children of a brick
  /// come before it.
  using SlabDone = std::function<Status(uint32_t level, uint32_t k)>;

  Pyramid(const glm::u32vec3& size, SlabDone done);

  /// The memory of a pyramid of this size, bytes; a double because sizes may be absurd.
  [[nodiscard]] static double bytes_for(const glm::u32vec3& size);

  /// Where the next plane of the source goes: size.x * size.y samples, i fastest. Fill it, then call add_plane().
  [[nodiscard]] std::span<Sample> next_plane() { return next_plane(levels_.front()); }
  Status add_plane() { return add_plane(0); }

  /// The samples of a brick with their halo, in the order of Brick::codes. Only while its slab is reported.
  [[nodiscard]] std::vector<double> samples(uint32_t level, const glm::u32vec3& brick) const;

 private:
  struct Level {
    glm::u32vec3 size{1};
    uint32_t planes = 0;  ///< added so far
    uint32_t slabs = 0;   ///< reported so far
    std::vector<Sample> ring;
  };

  std::span<Sample> next_plane(Level& level) { return plane(level, level.planes); }
  static std::span<Sample> plane(Level& level, uint32_t k);
  Status add_plane(uint32_t level);
  Status report_slabs(uint32_t level);
  Status add_mean(uint32_t level);

  SlabDone done_;
  std::vector<Level> levels_;
};

}  // namespace surfcast::volume
