#pragma once

#include <cstddef>
#include <vector>

#include "geometry/camera.h"
#include "gl/objects.h"
#include "model/model_file.h"

namespace surfcast::lab {

/// What splats are measured against: the surfels of the finest level drawn by the raster pipeline, the nearest one of
/// every pixel as it is.
enum class PlainShape {
  kPoint,  ///< GL points, squares as wide as the surfel's disc seen from the front
  kDisc,   ///< opaque discs of the surfel's radius in its plane, depth exact in every pixel
};

/// Which surfels of a scan whose normals tell front from back. Others are drawn all.
enum class PlainFaces {
  kFront,  ///< those that face the eye, as splats do
  kAll,    ///< as points without normals would be
};

/// Draws a coloured model plainly. Needs the current GL context.
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
