#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gl/objects.h"
#include "render/batch_sizer.h"
#include "render/storage_buffer.h"

namespace surfcast::render {

/// A growing buffer that shaders read as texels, filled again for every picture.
class UploadedTexels {
 public:
  UploadedTexels(const char* label, GLenum format) : label_(label), format_(format) {}

  template <typename T>
  void upload(const std::vector<T>& values) {
    write(std::as_bytes(std::span(values)));
  }
  void bind(GLuint unit) const { glBindTextureUnit(unit, texture_.name()); }

 private:
  void write(std::span<const std::byte> content);

  const char* label_;
  GLenum format_;
  size_t bytes_ = 0;
  gl::Buffer buffer_;
  gl::Texture texture_;
};

/// A growing storage buffer of vec4 that shaders also read as texels. (Software GL reads storage buffers lane by lane.)
class LightBuffer {
 public:
  explicit LightBuffer(const char* label) : label_(label) {}

  void reserve(size_t pixels);
  void bind(GLuint binding) const;
  void bind_texels(GLuint unit) const { glBindTextureUnit(unit, texture_.name()); }

 private:
  const char* label_;
  size_t pixels_ = 0;
  gl::Buffer buffer_;
  gl::Texture texture_;
};

/// What the passes over volumes read besides bricks, and the sizes of their batches.
struct VolumeBuffers {
  BatchSizer draw_batches;
  BatchSizer row_batches;
  BatchSizer column_batches;
  StorageBuffer constants{"volume constants"};
  StorageBuffer surfaces{"surfaces in volumes"};
  StorageBuffer clips{"clip boxes of volumes"};
  LightBuffer light{"light of volumes"};
  StorageBuffer layers{"surfaces for volumes"};
  StorageBuffer surface_light{"light of surfaces among volumes"};
  LightBuffer rows{"light of volumes, filtered along rows"};
  UploadedTexels bricks{"bricks", GL_RGBA32UI};
  UploadedTexels cells{"volume cells", GL_R32UI};
  UploadedTexels seen{"seen parts of bricks", GL_R32UI};
  UploadedTexels pages{"brick pages", GL_R32UI};
  UploadedTexels transfer{"transfer function", GL_RGBA32UI};
  UploadedTexels ramp{"colours of slices", GL_RGBA32F};
};

}  // namespace surfcast::render
