#include "residency/surfel_buffer.h"

#include <algorithm>

#include "base/contract.h"

namespace surfcast {
namespace {

constexpr size_t kFirstCapacity = size_t{1} << 20;  // surfels: 16 MiB

}  // namespace

size_t SurfelBuffer::device_limit() {
  GLint texels = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  return static_cast<size_t>(texels);
}

void SurfelBuffer::grow(size_t surfels) {
  SURFCAST_EXPECTS(surfels <= most_);
  const size_t capacity = std::clamp(std::max(2 * capacity_, surfels), std::min(kFirstCapacity, most_), most_);
  gl::Buffer larger = gl::make_buffer("surfels", capacity * sizeof(glm::uvec4), GL_DYNAMIC_STORAGE_BIT);
  if (capacity_ > 0) {
    glCopyNamedBufferSubData(buffer_.name(), larger.name(), 0, 0,
                             static_cast<GLsizeiptr>(capacity_ * sizeof(glm::uvec4)));
  }
  texture_ = gl::make_buffer_texture("surfels", GL_RGBA32UI, larger);
  buffer_ = std::move(larger);
  capacity_ = capacity;
}

void SurfelBuffer::write(size_t first, std::span<const glm::uvec4> surfels) {
  if (first + surfels.size() > capacity_) grow(first + surfels.size());
  glNamedBufferSubData(buffer_.name(), static_cast<GLintptr>(first * sizeof(glm::uvec4)),
                       static_cast<GLsizeiptr>(surfels.size_bytes()), surfels.data());
}

void SurfelBuffer::bind(GLuint unit) const {
  glBindTextureUnit(unit, texture_.name());
}

}  // namespace surfcast
