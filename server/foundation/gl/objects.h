#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include <epoxy/gl.h>

namespace surfcast::gl {

/// Move-only owner of one GL name. `Traits::destroy` deletes it.
template <typename Traits>
class Object {
 public:
  Object() = default;
  explicit Object(GLuint name) : name_(name) {}
  Object(Object&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Object& operator=(Object&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;
  ~Object() {
    if (name_ != 0) Traits::destroy(name_);
  }

  [[nodiscard]] GLuint name() const { return name_; }
  explicit operator bool() const { return name_ != 0; }

 private:
  GLuint name_ = 0;
};

struct BufferTraits {
  static void destroy(GLuint name) { glDeleteBuffers(1, &name); }
};
struct TextureTraits {
  static void destroy(GLuint name) { glDeleteTextures(1, &name); }
};
struct FramebufferTraits {
  static void destroy(GLuint name) { glDeleteFramebuffers(1, &name); }
};
struct VertexArrayTraits {
  static void destroy(GLuint name) { glDeleteVertexArrays(1, &name); }
};
struct ProgramTraits {
  static void destroy(GLuint name) { glDeleteProgram(name); }
};

using Buffer = Object<BufferTraits>;
using Texture = Object<TextureTraits>;
using Framebuffer = Object<FramebufferTraits>;
using VertexArray = Object<VertexArrayTraits>;
using Program = Object<ProgramTraits>;

/// A buffer with immutable storage filled from `content`, with a debug label.
Buffer make_buffer(const char* label, std::span<const std::byte> content, GLbitfield flags = 0);
/// A buffer with immutable storage of undefined content.
Buffer make_buffer(const char* label, size_t bytes, GLbitfield flags = 0);
/// True if the driver can make buffers of client memory without a copy (GL_AMD_pinned_memory).
bool can_adopt_memory();
/// A buffer whose storage is `memory` itself, which must outlive the buffer. Requires can_adopt_memory().
Buffer adopt_memory(const char* label, std::span<std::byte> memory);
Texture make_texture_2d(const char* label, GLenum internal_format, int width, int height);
/// A buffer texture: the buffer as a one-dimensional array of texels.
Texture make_buffer_texture(const char* label, GLenum internal_format, const Buffer& buffer);
VertexArray make_empty_vertex_array(const char* label);
Framebuffer make_framebuffer(const char* label);

/// A debug group: names a pass in GL debuggers for the lifetime of the object.
class DebugGroup {
 public:
  explicit DebugGroup(const char* name) { glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, -1, name); }
  ~DebugGroup() { glPopDebugGroup(); }
  DebugGroup(const DebugGroup&) = delete;
  DebugGroup& operator=(const DebugGroup&) = delete;
};

}  // namespace surfcast::gl
