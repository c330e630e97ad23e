#pragma once

#include "base/lazy_memory.h"
#include "gl/objects.h"
#include "residency/surfel_pool.h"

namespace surfcast::residency {

/// The GPU memory of a surfel pool: one buffer, read through one buffer texture, so that a frame binds it once however
/// many blocks it draws. Needs the current GL context.
///
/// In software the buffer is as large as it may get from the beginning, made of memory of which only what is written
/// counts: there a larger buffer takes up to a second, because the driver clears it. On hardware that is no matter, but
/// memory that is set aside is taken from others; the buffer grows with what is written, by doubling.
class SurfelBuffer : public SurfelSink {
 public:
  /// Surfels that the device can hold in one buffer texture.
  static size_t device_limit();

  /// Holds `most` surfels at most, which the device can. `software`: pixels are computed by the CPU.
  SurfelBuffer(size_t most, bool software) : most_(most), lazy_(software && gl::can_adopt_memory()) {}

  void write(size_t first, std::span<const glm::uvec4> surfels) override;
  void write_attributes(size_t first, std::span<const uint32_t> attributes) override;
  void bind(GLuint unit) const { surfels_.bind(unit); }
  /// The attributes, once any were written.
  void bind_attributes(GLuint unit) const { attributes_.bind(unit); }

 private:
  /// A buffer texture that grows and keeps its content.
  class Texels {
   public:
    Texels(const char* label, GLenum format, size_t texel_bytes)
        : label_(label), format_(format), texel_bytes_(texel_bytes) {}
    void write(size_t first, std::span<const std::byte> bytes, size_t most, bool lazy);
    void bind(GLuint unit) const { glBindTextureUnit(unit, texture_.name()); }

   private:
    void take_all(size_t most);
    void grow(size_t texels, size_t most);

    const char* label_;
    GLenum format_;
    size_t texel_bytes_;
    size_t capacity_ = 0;
    LazyMemory memory_;  ///< of the buffer, in software
    gl::Buffer buffer_;
    gl::Texture texture_;
  };

  size_t most_;
  bool lazy_;
  Texels surfels_{"surfels", GL_RGBA32UI, sizeof(glm::uvec4)};
  Texels attributes_{"attributes", GL_R32UI, sizeof(uint32_t)};
};

}  // namespace surfcast::residency
