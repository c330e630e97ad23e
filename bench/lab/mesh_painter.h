#pragma once

#include <vector>

#include "geometry/camera.h"
#include "gl/objects.h"
#include "mesh/mesh.h"
#include "reference/light_picture.h"

namespace surfcast::lab {

/// The usual way to draw a textured mesh, for comparison: GL triangles, a mip-map in linear light, and as many
/// anisotropic probes as the device has. Patches without texture are left out.
class MeshPainter {
 public:
  /// Needs a current GL context, now and later. Ends the program if an image cannot be read.
  explicit MeshPainter(const mesh::Mesh& mesh);

  /// The largest number of probes of a texture access.
  [[nodiscard]] int probes() const { return probes_; }

  /// One sample at the centre of each of `samples` x `samples` cells of a pixel, of a picture that is
  /// reference::kFilterReach pixels wider on every side.
  [[nodiscard]] reference::LightPicture draw(const geometry::CameraFrame& frame, int samples) const;

 private:
  struct Part {
    gl::Buffer corners;
    GLsizei count = 0;
    gl::Texture texture;
  };

  void add(const mesh::Mesh& mesh, const mesh::Patch& patch);

  int probes_ = 1;
  gl::Program program_;
  gl::VertexArray vertices_;
  std::vector<Part> parts_;
};

}  // namespace surfcast::lab
