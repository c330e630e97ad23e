#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/lazy_memory.h"
#include "gl/objects.h"
#include "render/batch_sizer.h"
#include "render/storage_buffer.h"
#include "render/tile_spans.h"
#include "render/volume_buffers.h"

namespace surfcast::render {

/// A growing buffer, accessed as texels: splat records may exceed the size limit of a storage block, but not that of a
/// texel buffer.
class TexelBuffer {
 public:
  /// `flags`: GL_DYNAMIC_STORAGE_BIT for buffers that write() fills.
  TexelBuffer(const char* label, GLenum format, size_t texel_bytes, GLbitfield flags = 0)
      : label_(label), format_(format), texel_bytes_(texel_bytes), flags_(flags) {}

  /// Makes room for `texels`; the content is undefined. `lazily`: in lazily committed memory, where only written pages
  /// count (software GL only).
  void reserve(size_t texels, bool lazily = false);
  void bind_for_writing(GLuint unit) const;
  void bind_for_reading(GLuint unit) const;
  void write(std::span<const std::byte> bytes) const;
  void read(std::span<std::byte> bytes) const;
  [[nodiscard]] size_t texels() const { return texels_; }

 private:
  const char* label_;
  GLenum format_;
  size_t texel_bytes_;
  GLbitfield flags_;
  size_t texels_ = 0;
  LazyMemory memory_;  ///< memory of the buffer if it was reserved lazily
  gl::Buffer buffer_;
  gl::Texture texture_;
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

/// The buffers between the passes of Gaussians (gaussian_passes.h).
struct GaussianBuffers {
  BatchSizer project_batches;
  BatchSizer blend_batches;
  TexelBuffer records{"Gaussians", GL_RGBA32UI, 16};
  TexelBuffer keys{"depths and tiles of Gaussians", GL_RGBA32UI, 16};
  TexelBuffer lists{"lists of Gaussians", GL_R32UI, 4, GL_DYNAMIC_STORAGE_BIT};
  StorageBuffer tiles{"tiles of Gaussians"};
  StorageBuffer layers{"Gaussians for volumes"};
};

/// The buffers between the passes of ellipsoids (ellipsoid_passes.h).
struct EllipsoidBuffers {
  BatchSizer project_batches;
  BatchSizer nearest_batches;
  BatchSizer shade_batches;
  BatchSizer row_batches;
  BatchSizer column_batches;
  TexelBuffer records{"ellipsoids", GL_RGBA32UI, 16};
  TexelBuffer keys{"depths and tiles of ellipsoids", GL_RGBA32UI, 16};
  TexelBuffer lists{"lists of ellipsoids", GL_R32UI, 4, GL_DYNAMIC_STORAGE_BIT};
  StorageBuffer tiles{"tiles of ellipsoids"};
  StorageBuffer frame{"frame of samples"};
  StorageBuffer views{"views of blocks of ellipsoids"};
  StorageBuffer ranges{"thresholds and layers"};
  StorageBuffer lighting{"lighting"};
  StorageBuffer lights{"lights"};
  StorageBuffer ids{"ellipsoids of samples"};
  StorageBuffer depths{"depths of samples"};
  StorageBuffer shades{"light of samples"};
  StorageBuffer rows{"filtered rows of samples"};
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
  StorageBuffer through{"opacities of ghosts and classes"};
  StorageBuffer light{"light before eye-dome lighting"};
  StorageBuffer depth{"depth"};
  StorageBuffer eye_dome{"eye-dome constants"};
  StorageBuffer fronts{"fronts"};
  StorageBuffer shown_depths{"shown depths"};
  StorageBuffer silhouettes{"silhouettes"};
  VolumeBuffers volume;
  GaussianBuffers gaussians;
  EllipsoidBuffers ellipsoids;
  /// Buffers use lazily committed memory, where only written pages count. Then there may be room for all surfels of a
  /// view from the beginning.
  bool lazy = false;

  /// Makes room for `count` splat records; for normals only in lit scenes with colour.
  void reserve_splats(size_t count, bool with_normals);
  [[nodiscard]] size_t splat_capacity() const { return discs.texels(); }
};

/// Binds the buffers that every pass uses.
void bind_frame(const SplatBuffers& buffers);

}  // namespace surfcast::render
