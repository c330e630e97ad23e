// Buffer layouts of the pass that draws volumes, for C++ and GLSL (see shared/frame_layout.h).
#ifndef SURFCAST_SHARED_VOLUME_LAYOUT_H
#define SURFCAST_SHARED_VOLUME_LAYOUT_H

#ifdef __cplusplus
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
namespace surfcast::layout {
#define SURFCAST_VEC4 glm::vec4
#define SURFCAST_IVEC4 glm::ivec4
#define SURFCAST_UVEC4 glm::uvec4
#else
#define SURFCAST_VEC4 vec4
#define SURFCAST_IVEC4 ivec4
#define SURFCAST_UVEC4 uvec4
#endif

// Samples of a brick along an axis, of a sub-brick, and those that a brick stores before its own.
#define SURFCAST_BRICK 32
#define SURFCAST_SUB_BRICK 2
#define SURFCAST_BRICK_HALO 2
// A texel of a brick holds 8 codes of a row, and the next texel begins 5 codes later: four successive codes are always
// in one texel.
#define SURFCAST_WINDOW_STRIDE 5
// Texels of a page of GPU memory. A slice of a brick lies within one page.
#define SURFCAST_PAGE_TEXELS 1024
// Pixels that the prefilter of volumes reaches, and the margin for which their light is computed.
#define SURFCAST_VOLUME_REACH 4
// Bins of a transfer function between its first and last point.
#define SURFCAST_TRANSFER_BINS 4096

// Surfaces of a pixel that are kept, front to back, and the words of each (see include/keep_layer.glsl).
#define SURFCAST_LAYERS_KEPT 8
#define SURFCAST_LAYER_WORDS 3

// One volume in one region. A place on a ray is given by the distance from the anchor, t: it lies at anchor.w + t from
// the eye. The anchor is the volume's centre, or the eye if it is within the volume.
struct VolumeConstants {
  SURFCAST_VEC4 to_index[3];  // columns: source indices per world unit along the camera's x, y and z; w: the anchor's
  SURFCAST_VEC4 anchor;       // unit vector from the eye to the anchor, camera axes; w: its distance, world units
  SURFCAST_VEC4 low;          // faces of the volume, source indices; w: first entry in the table of transfer functions
  SURFCAST_VEC4 high;         // w: coarsest step, in samples of a brick's level
  SURFCAST_IVEC4 cells;       // bricks of the finest level along the axes; w: first entry in the table of cells
  SURFCAST_IVEC4 light;       // the pixels for which light is computed: first x and y in the picture, width, height
  SURFCAST_VEC4 transfer;     // x: the last bin, y: optical depth per unit of the table, z: of its colours;
                              // w: world units per unit of the depths of surfaces
  SURFCAST_IVEC4 clips;       // clip boxes of which one must contain what is seen (0: no condition), and of those that
                              // must not; first of both in the table of clip boxes; number of volumes
};

// A brick that is drawn.
struct BrickView {
  SURFCAST_UVEC4 place;  // its first page in the list of pages, texels per row, per slice, slices per page
  SURFCAST_UVEC4 kind;   // x: level; y: last cell with four samples about it along i, j and k, 8 bits each
  SURFCAST_VEC4 scale;   // stored index = scale * source index + offset; w: bins of the transfer function per code
  SURFCAST_VEC4 offset;  // w: bin of code 0
  SURFCAST_VEC4 low;     // box of the brick, source indices
  SURFCAST_VEC4 high;
};

// Iso-surfaces and slices of one volume. Opacities and linear colours of iso-surfaces; the plane of a slice is where
// dot(xyz, source index) = w.
#define SURFCAST_VOLUME_SURFACES 8
struct VolumeSurfaces {
  SURFCAST_IVEC4 counts;        // iso-surfaces, slices, points of the ramp; 1: iso-surfaces are lit
  SURFCAST_VEC4 slice_opacity;  // x
  SURFCAST_VEC4 iso_scalars[SURFCAST_VOLUME_SURFACES];  // x: bins of the transfer function
  SURFCAST_VEC4 iso_colors[SURFCAST_VOLUME_SURFACES];
  SURFCAST_VEC4 slices[SURFCAST_VOLUME_SURFACES];
};

// A clip box relative to the anchor, world axes.
struct VolumeClip {
  SURFCAST_VEC4 low;
  SURFCAST_VEC4 high;
};

// Storage buffers of these passes.
#define SURFCAST_BIND_VOLUME_CLIPS 1  // VolumeClip
#define SURFCAST_BIND_VOLUME_LIGHT 2  // vec4 per pixel of VolumeConstants::light: premultiplied linear light, opacity
#define SURFCAST_BIND_VOLUME_ROWS 10  // the same, filtered along rows, for the requested columns
#define SURFCAST_BIND_LAYERS 13       // uint: surfaces of the pixels of the frame's region; inverse depth 0: no further
#define SURFCAST_BIND_SURFACE_LIGHT 12  // vec4 per pixel of VolumeConstants::light: what surfaces add to it
#define SURFCAST_BIND_KEPT 11           // uint: layers with Gaussians, as codes, in the pass that blends them
// Uniform buffer:
#define SURFCAST_BIND_VOLUME 1
#define SURFCAST_BIND_VOLUME_SURFACES 3
// Texture units of buffers:
#define SURFCAST_UNIT_CELLS 0     // uint per brick of the finest level: number of its BrickView + 1, 0: nothing is seen
#define SURFCAST_UNIT_PAGES 1     // uint per page of a brick: its first texel
#define SURFCAST_UNIT_BRICKS 3    // BrickView, six texels
#define SURFCAST_UNIT_RAMP 8      // vec4 per point of the transfer function: linear colour, bin
#define SURFCAST_UNIT_TRANSFER 2  // uvec4 per bin: sums of colour and extinction of the bins before it
// SURFCAST_SEEN_WORDS uints per BrickView: bits of the sub-bricks in which something may be seen.
#define SURFCAST_UNIT_SEEN 6
// The buffers of these names, for the filter.
#define SURFCAST_UNIT_VOLUME_LIGHT 4
#define SURFCAST_UNIT_VOLUME_ROWS 7

#define SURFCAST_NO_CELL 0u

// Where the bit of a sub-brick is. A word has 4 x 4 x 2 sub-bricks, a byte of it 2 x 2 x 2.
#define SURFCAST_SEEN_WORDS 128
#ifdef __cplusplus
inline int seen_word(const glm::ivec3& sub) {
#else
int seen_word(ivec3 sub) {
#endif
  return ((sub.z >> 1) * 4 + (sub.y >> 2)) * 4 + (sub.x >> 2);
}
#ifdef __cplusplus
inline int seen_bit(const glm::ivec3& sub) {
#else
int seen_bit(ivec3 sub) {
#endif
  return (sub.x & 1) | (sub.y & 1) << 1 | (sub.z & 1) << 2 | (sub.x & 2) << 2 | (sub.y & 2) << 3;
}

#ifdef __cplusplus
static_assert(sizeof(VolumeConstants) == 160);
static_assert(sizeof(BrickView) == 96);
}  // namespace surfcast::layout
#endif
#undef SURFCAST_VEC4
#undef SURFCAST_IVEC4
#undef SURFCAST_UVEC4

#endif
