#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/lazy_memory.h"
#include "gl/objects.h"
#include "render/batch_sizer.h"
#include "render/tile_spans.h"

namespace surfcast::render {

/// A growing buffer, accessed as texels: splat records may exceed the size limit of a storage block, but not that of a
/// texel buffer.
class TexelBuffer {
 public:
  TexelBuffer(const char* label, GLenum format, size_t texel_bytes)
      : label_(label), format_(format), texel_bytes_(texel_bytes) {}

  /// Makes room for `texels`; the content is undefined. `lazily`: in lazily committed memory, where only written pages
  /// count (software GL only).
  void reserve(size_t texels, bool lazily = false);
  void bind_for_writing(GLuint unit) const;
  void bind_for_reading(GLuint unit) const;
  [[nodiscard]] size_t texels() const { return texels_; }

 private:
  const char* label_;
  GLenum format_;
  size_t texel_bytes_;
  size_t texels_ = 0;
  LazyMemory memory_;  ///< memory of the buffer if it was reserved lazily
  gl::Buffer buffer_;
  gl::Texture texture_;
};

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

/// A table of constants for shaders.
class ConstantTexels {
 public:
  /// Needs a current GL context.
  static ConstantTexels make(const char* label, std::span<const uint32_t> values);
  void bind(GLuint unit) const;

 private:
  gl::Buffer buffer_;
  gl::Texture texture_;
};

/// The batch sizes of the passes over tiles with long lists.
struct LongListBatches {
  BatchSizer splat;
  BatchSizer splat_large;
  BatchSizer supersample;
  BatchSizer supersample_large;
};

/// The buffers between the passes of one region, and the batch sizes of the passes.
struct SplatBuffers {
  BatchSizer project_batches;
  BatchSizer count_large_batches;
  BatchSizer slice_batches;
  BatchSizer bin_batches;
  std::array<BatchSizer, kTileSpans> splat_batches;
  BatchSizer splat_large_batches;
  BatchSizer behind_batches;
  BatchSizer find_batches;
  BatchSizer supersample_batches;
  BatchSizer supersample_large_batches;
  BatchSizer behind_samples_batches;
  LongListBatches long_lists;
  ConstantTexels srgb;  ///< linear_root_table
  TexelBuffer splats{"splats", GL_RGBA32UI, 16};
  TexelBuffer discs{"discs", GL_RGBA32UI, 16};
  TexelBuffer bounds{"bounds", GL_RG32UI, 8};
  TexelBuffer normals{"splat normals", GL_R32UI, 4};
  TexelBuffer unfinished{"unfinished columns", GL_RGBA32UI, 16};
  TexelBuffer lists{"tile lists", GL_R32UI, 4};
  TexelBuffer reaches{"reaches of list entries", GL_R32UI, 4};
  StorageBuffer counters{"counters"};
  StorageBuffer tile_count{"tile count"};
  StorageBuffer tile_offset{"tile offset"};
  StorageBuffer tile_order{"tile order"};
  StorageBuffer next_tiles{"next tiles"};
  StorageBuffer unfinished_count{"number of unfinished columns"};
  StorageBuffer picture{"picture"};
  StorageBuffer blocks{"blocks"};
  StorageBuffer chunks{"chunks"};
  StorageBuffer frame{"frame constants"};
  StorageBuffer block_displays{"display options of blocks"};
  StorageBuffer clips{"clip ranges"};
  StorageBuffer display{"display constants"};
  StorageBuffer light{"light before eye-dome lighting"};
  StorageBuffer depth{"depth"};
  StorageBuffer eye_dome{"eye-dome constants"};
  StorageBuffer fronts{"fronts"};
  StorageBuffer silhouettes{"silhouettes"};
  /// Buffers use lazily committed memory, where only written pages count. Then there may be room for all surfels of a
  /// view from the beginning.
  bool lazy = false;

  /// Makes room for `count` splat records; for normals only in lit scenes with colour.
  void reserve_splats(size_t count, bool with_normals);
  [[nodiscard]] size_t splat_capacity() const { return discs.texels(); }
};

}  // namespace surfcast::render
