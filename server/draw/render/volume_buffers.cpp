#include "render/volume_buffers.h"

#include <glm/vec4.hpp>

namespace surfcast::render {

void UploadedTexels::write(std::span<const std::byte> content) {
  if (content.size() > bytes_ || !buffer_) {
    bytes_ = content.size();
    texture_ = gl::Texture();
    buffer_ = gl::make_buffer(label_, bytes_, GL_DYNAMIC_STORAGE_BIT);
    texture_ = gl::make_buffer_texture(label_, format_, buffer_);
  }
  glNamedBufferSubData(buffer_.name(), 0, static_cast<GLsizeiptr>(content.size()), content.data());
}

void LightBuffer::reserve(size_t pixels) {
  if (pixels <= pixels_) return;
  pixels_ = pixels;
  texture_ = gl::Texture();
  buffer_ = gl::make_buffer(label_, pixels * sizeof(glm::vec4), GL_DYNAMIC_STORAGE_BIT);
  texture_ = gl::make_buffer_texture(label_, GL_RGBA32F, buffer_);
}

void LightBuffer::bind(GLuint binding) const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer_.name());
}

}  // namespace surfcast::render
