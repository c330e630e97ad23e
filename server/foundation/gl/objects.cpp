#include "gl/objects.h"

#include <algorithm>

namespace surfcast::gl {
namespace {

Buffer make_storage(const char* label, const void* content, size_t bytes, GLbitfield flags) {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  // GL rejects empty storage. Four bytes cost nothing, and every buffer stays bindable.
  glNamedBufferStorage(name, static_cast<GLsizeiptr>(std::max<size_t>(bytes, 4)), bytes == 0 ? nullptr : content,
                       flags);
  glObjectLabel(GL_BUFFER, name, -1, label);
  return Buffer(name);
}

}  // namespace

Buffer make_buffer(const char* label, std::span<const std::byte> content, GLbitfield flags) {
  return make_storage(label, content.data(), content.size(), flags);
}

Buffer make_buffer(const char* label, size_t bytes, GLbitfield flags) {
  return make_storage(label, nullptr, bytes, flags);
}

bool can_adopt_memory() {
  return epoxy_has_gl_extension("GL_AMD_pinned_memory");
}

Buffer adopt_memory(const char* label, std::span<std::byte> memory) {
  constexpr GLenum kTarget = GL_EXTERNAL_VIRTUAL_MEMORY_BUFFER_AMD;
  GLuint name = 0;
  glGenBuffers(1, &name);
  glBindBuffer(kTarget, name);
  glBufferData(kTarget, static_cast<GLsizeiptr>(memory.size()), memory.data(), GL_DYNAMIC_DRAW);
  glBindBuffer(kTarget, 0);
  glObjectLabel(GL_BUFFER, name, -1, label);
  return Buffer(name);
}

Texture make_texture_2d(const char* label, GLenum internal_format, int width, int height) {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  glTextureStorage2D(name, 1, internal_format, width, height);
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glObjectLabel(GL_TEXTURE, name, -1, label);
  return Texture(name);
}

Texture make_buffer_texture(const char* label, GLenum internal_format, const Buffer& buffer) {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_BUFFER, 1, &name);
  glTextureBuffer(name, internal_format, buffer.name());
  glObjectLabel(GL_TEXTURE, name, -1, label);
  return Texture(name);
}

VertexArray make_empty_vertex_array(const char* label) {
  GLuint name = 0;
  glCreateVertexArrays(1, &name);
  glObjectLabel(GL_VERTEX_ARRAY, name, -1, label);
  return VertexArray(name);
}

Framebuffer make_framebuffer(const char* label) {
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  glObjectLabel(GL_FRAMEBUFFER, name, -1, label);
  return Framebuffer(name);
}

}  // namespace surfcast::gl
