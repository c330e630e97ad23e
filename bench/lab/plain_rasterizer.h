#pragma once

#include <cstddef>
#include <vector>

#include "geometry/camera.h"
#include "gl/objects.h"
#include "model/model_file.h"

namespace surfcast::lab {

/// The plain methods with which splats are compared: the raster pipeline draws the surfels of the finest level, and
/// each pixel shows the nearest surfel without filtering.
enum class PlainShape {
  kPoint,  ///< GL points: squares as wide as the surfel's disc seen from the front
  kDisc,   ///< opaque discs of the surfel's radius in its plane, with exact depth in every pixel
};

/// The surfels that are drawn of a scan with oriented normals. Of other scans, all surfels are drawn.
enum class PlainFaces {
  kFront,  ///< front-facing surfels, as with splats
  kAll,    ///< all surfels, as with points without normals
};

/// Draws a model with a plain method. Needs a current GL context.
class PlainRasterizer {
 public:
  PlainRasterizer(const model::ModelFile& model, int width, int height);

  /// Draws surfels and reads the picture, RGBA8, rows from bottom to top.
  void draw(PlainShape shape, PlainFaces faces, const geometry::CameraFrame& frame,
            std::vector<std::byte>& pixels) const;

 private:
  struct Block {
    gl::Buffer surfels;
    GLsizei count = 0;
    glm::dvec3 origin{0};  ///< world
  };

  void add_block(const model::ModelFile& model, uint32_t index);

  int width_;
  int height_;
  bool oriented_;
  gl::VertexArray vertices_;
  gl::Texture color_;
  gl::Texture depth_;
  gl::Framebuffer target_;
  gl::Program points_;
  gl::Program discs_;
  std::vector<Block> blocks_;
};

}  // namespace surfcast::lab
