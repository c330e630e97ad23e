#include "render/storage_buffer.h"

namespace surfcast::render {

void StorageBuffer::reserve(size_t bytes) {
  if (bytes <= bytes_) return;
  bytes_ = bytes;
  buffer_ = gl::make_buffer(label_, bytes, GL_DYNAMIC_STORAGE_BIT);
}

void StorageBuffer::clear() const {
  glClearNamedBufferData(buffer_.name(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
}

void StorageBuffer::bind(GLuint binding) const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer_.name());
}

void StorageBuffer::bind_uniforms(GLuint binding) const {
  glBindBufferBase(GL_UNIFORM_BUFFER, binding, buffer_.name());
}

}  // namespace surfcast::render
