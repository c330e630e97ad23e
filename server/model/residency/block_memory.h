#pragma once

#include "base/lazy_memory.h"
#include "gl/objects.h"
#include "residency/block_pool.h"

namespace surfcast::residency {

/// The GPU memory of a surfel pool: one buffer, read through one buffer texture. A frame binds it once, however many
/// blocks it draws. Needs a current GL context.
///
/// With software GL the buffer has its full size from the beginning. It is made of lazily committed memory, where only
/// written pages count. (Enlarging a buffer takes up to a second there, because the driver clears it.) With hardware
/// GL, enlarging is cheap but reserved memory is lost to other programs. So the buffer doubles as it fills, and is
/// written by copies on the device alone: see UploadRing.
class BlockMemory : public TexelSink {
 public:
  /// Size of the UploadRing.
  static constexpr size_t kRingBytes = size_t{4} << 20;

  /// The largest number of surfels in one buffer texture of the device.
  static size_t device_limit();

  /// `most`: capacity in surfels, not above device_limit(). `software`: the CPU computes the pixels.
  BlockMemory(size_t most, bool software) : most_(most), lazy_(software && gl::can_adopt_memory()) {}

  void write(size_t first, std::span<const glm::uvec4> surfels) override;
  void write_attributes(size_t first, std::span<const uint32_t> attributes) override;
  void bind(GLuint unit) const { surfels_.bind(unit); }
  /// Binds the attributes. Some must have been written.
  void bind_attributes(GLuint unit) const { attributes_.bind(unit); }

 private:
  /// A small buffer that the host writes, and that the device copies from. A driver may move a large buffer that the
  /// host may write (GL_DYNAMIC_STORAGE_BIT): on an H200 the first write after each enlargement took 0.63 ms per MiB.
  class UploadRing {
   public:
    void copy(std::span<const std::byte> bytes, const gl::Buffer& target, size_t offset);

   private:
    void copy_piece(std::span<const std::byte> piece, const gl::Buffer& target, size_t offset);

    gl::Buffer buffer_;
    size_t next_ = 0;  ///< where the next piece goes
  };

  /// A growing buffer texture that keeps its content.
  class Texels {
   public:
    Texels(const char* label, GLenum format, size_t texel_bytes)
        : label_(label), format_(format), texel_bytes_(texel_bytes) {}
    void write(size_t first, std::span<const std::byte> bytes, size_t most, bool lazy, UploadRing& ring);
    void bind(GLuint unit) const { glBindTextureUnit(unit, texture_.name()); }

   private:
    void take_all(size_t most);
    void grow(size_t texels, size_t most);

    const char* label_;
    GLenum format_;
    size_t texel_bytes_;
    size_t capacity_ = 0;
    LazyMemory memory_;  ///< memory of the buffer with software GL
    gl::Buffer buffer_;
    gl::Texture texture_;
  };

  size_t most_;
  bool lazy_;
  UploadRing ring_;
  Texels surfels_{"surfels", GL_RGBA32UI, sizeof(glm::uvec4)};
  Texels attributes_{"attributes", GL_R32UI, sizeof(uint32_t)};
};

}  // namespace surfcast::residency
