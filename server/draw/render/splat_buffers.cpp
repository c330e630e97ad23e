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
  buffer_ = memory_.bytes().empty() ? gl::make_buffer(label_, texels * texel_bytes_, flags_)
                                    : gl::adopt_memory(label_, memory_.bytes());
  texture_ = gl::make_buffer_texture(label_, format_, buffer_);
}

void TexelBuffer::bind_for_writing(GLuint unit) const {
  glBindImageTexture(unit, texture_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, format_);
}

void TexelBuffer::bind_for_reading(GLuint unit) const {
  glBindTextureUnit(unit, texture_.name());
}

void TexelBuffer::write(std::span<const std::byte> bytes) const {
  glNamedBufferSubData(buffer_.name(), 0, static_cast<GLsizeiptr>(bytes.size()), bytes.data());
}

void TexelBuffer::read(std::span<std::byte> bytes) const {
  glGetNamedBufferSubData(buffer_.name(), 0, static_cast<GLsizeiptr>(bytes.size()), bytes.data());
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

void bind_frame(const SplatBuffers& buffers) {
  buffers.frame.bind_uniforms(SURFCAST_BIND_FRAME);
  buffers.counters.bind(SURFCAST_BIND_COUNTERS);
  buffers.tile_count.bind(SURFCAST_BIND_TILE_COUNT);
  buffers.tile_offset.bind(SURFCAST_BIND_TILE_OFFSET);
  buffers.tile_order.bind(SURFCAST_BIND_TILE_ORDER);
}

}  // namespace surfcast::render
