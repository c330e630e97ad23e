#include "render/splat_buffers.h"

#include <algorithm>

namespace surfcast::render {

void TexelBuffer::reserve(size_t texels, bool lazily) {
  if (texels <= texels_) return;
  texels_ = texels;
  texture_ = gl::Texture();
  buffer_ = gl::Buffer();
  glFinish();  // the GPU must not write to memory that is released
  memory_ = lazily ? LazyMemory(texels * texel_bytes_) : LazyMemory();
  buffer_ = memory_.bytes().empty() ? gl::make_buffer(label_, texels * texel_bytes_)
                                    : gl::adopt_memory(label_, memory_.bytes());
  texture_ = gl::make_buffer_texture(label_, format_, buffer_);
}

void TexelBuffer::bind_for_writing(GLuint unit) const {
  glBindImageTexture(unit, texture_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, format_);
}

void TexelBuffer::bind_for_reading(GLuint unit) const {
  glBindTextureUnit(unit, texture_.name());
}

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

ConstantTexels ConstantTexels::make(const char* label, std::span<const uint32_t> values) {
  ConstantTexels table;
  table.buffer_ = gl::make_buffer(label, std::as_bytes(values));
  table.texture_ = gl::make_buffer_texture(label, GL_R32UI, table.buffer_);
  return table;
}

void ConstantTexels::bind(GLuint unit) const {
  glBindTextureUnit(unit, texture_.name());
}

void SplatBuffers::reserve_splats(size_t count, bool with_normals) {
  splats.reserve(2 * count, lazy);
  discs.reserve(count, lazy);
  bounds.reserve(count, lazy);
  if (with_normals) normals.reserve(std::max(count, discs.texels()), lazy);
}

}  // namespace surfcast::render
