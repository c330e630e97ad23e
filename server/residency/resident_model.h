#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "base/result.h"
#include "gl/objects.h"
#include "model/model_file.h"

namespace surfcast {

/// Where a block lies on the GPU.
struct ResidentBlock {
  glm::dvec3 origin{0};    ///< world; its positions are relative to it
  double radius_unit = 0;  ///< world units
  size_t arena = 0;
  uint32_t first = 0;  ///< index of its first surfel in the arena
  uint32_t surfels = 0;
};

/// Surfels of many blocks in one set of buffers, as the projection reads them.
struct Arena {
  gl::Buffer geometry;
  gl::Buffer size_and_weight;
  gl::Buffer colors;  ///< no name where the scan has no colour
  uint32_t surfels = 0;
};

/// All blocks of one model on the GPU. Needs the current GL context.
class ResidentModel {
 public:
  /// Decodes every block on all cores and uploads it. Storage blocks of GL end at 128 MiB on some devices, so that
  /// surfels are spread over several arenas.
  static Result<ResidentModel> load(const ModelFile& model);

  [[nodiscard]] const std::vector<ResidentBlock>& blocks() const { return blocks_; }
  [[nodiscard]] const std::vector<Arena>& arenas() const { return arenas_; }
  [[nodiscard]] size_t gpu_bytes() const { return gpu_bytes_; }

 private:
  std::vector<ResidentBlock> blocks_;
  std::vector<Arena> arenas_;
  size_t gpu_bytes_ = 0;
};

}  // namespace surfcast
