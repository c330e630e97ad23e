#include "render/volume_buffers.h"

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

}  // namespace surfcast::render
