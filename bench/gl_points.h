#pragma once

#include "gl/objects.h"
#include "render/picture.h"
#include "residency/resident_model.h"

namespace surfcast::bench {

/// The plain way: every surfel of the same buffers as a GL point whose size follows its radius, depth tested, opaque.
/// What the splatting renderer is compared with. Needs the current GL context.
class GlPoints {
 public:
  GlPoints(int width, int height);

  /// Draws one frame and reads it back, as the splatting renderer does.
  void draw(const ResidentModel& model, const CameraFrame& frame, std::vector<std::byte>& pixels);

 private:
  int width_;
  int height_;
  gl::Program program_;
  gl::VertexArray vertices_;
  gl::Texture color_;
  gl::Texture depth_;
  gl::Framebuffer target_;
};

}  // namespace surfcast::bench
