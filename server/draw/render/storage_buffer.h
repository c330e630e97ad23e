#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "gl/objects.h"

namespace surfcast::render {

/// A growing storage buffer.
class StorageBuffer {
 public:
  explicit StorageBuffer(const char* label) : label_(label) {}

  void reserve(size_t bytes);
  void clear() const;
  [[nodiscard]] GLuint name() const { return buffer_.name(); }
  void bind(GLuint binding) const;
  void bind_uniforms(GLuint binding) const;

 private:
  const char* label_;
  size_t bytes_ = 0;
  gl::Buffer buffer_;
};

template <typename T>
void upload(StorageBuffer& buffer, const std::vector<T>& values) {
  buffer.reserve(std::max<size_t>(values.size(), 1) * sizeof(T));  // a view without blocks binds a buffer too
  glNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data());
}

template <typename T>
void upload_uniforms(StorageBuffer& buffer, const T& constants) {
  buffer.reserve(sizeof constants);
  glNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(sizeof constants), &constants);
}

}  // namespace surfcast::render
