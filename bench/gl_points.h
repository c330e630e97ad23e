#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/camera.h"
#include "gl/objects.h"
#include "model/model_file.h"

namespace surfcast::bench {

/// The finest level of a coloured model as plain GL points whose squares are as wide as the largest disc of their
/// block: what splats are measured against. Needs the current GL context.
class GlPoints {
 public:
  GlPoints(const ModelFile& model, int width, int height);

  /// Draws all blocks and reads the picture, RGBA8, rows from bottom to top.
  void draw(const CameraFrame& frame, std::vector<std::byte>& pixels) const;

 private:
  struct Block {
    gl::Buffer points;
    GLsizei count = 0;
    glm::dvec3 origin{0};  ///< world
    float radius = 0;      ///< largest, world units
  };

  void add_block(const ModelFile& model, uint32_t index);

  int width_;
  int height_;
  gl::VertexArray vertices_;
  gl::Texture color_;
  gl::Texture depth_;
  gl::Framebuffer target_;
  gl::Program program_;
  std::vector<Block> blocks_;
};

}  // namespace surfcast::bench
