#pragma once

#include "gl/objects.h"
#include "residency/surfel_pool.h"

namespace surfcast {

/// The GPU memory of a surfel pool: one buffer, read through one buffer texture, so that a frame binds it once however
/// many blocks it draws. Grows with what is written, by doubling. Needs the current GL context.
class SurfelBuffer : public SurfelSink {
 public:
  /// Surfels that the device can hold in one buffer texture.
  static size_t device_limit();

  /// Holds `most` surfels at most, which the device can.
  explicit SurfelBuffer(size_t most) : most_(most) {}

  void write(size_t first, std::span<const glm::uvec4> surfels) override;
  void bind(GLuint unit) const;

 private:
  void grow(size_t surfels);

  size_t most_;
  size_t capacity_ = 0;
  gl::Buffer buffer_;
  gl::Texture texture_;
};

}  // namespace surfcast
