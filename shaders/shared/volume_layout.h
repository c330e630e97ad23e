// Buffer layouts of the pass that draws volumes, for C++ and GLSL (see shared/frame_layout.h).
#ifndef SURFCAST_SHARED_VOLUME_LAYOUT_H
#define SURFCAST_SHARED_VOLUME_LAYOUT_H

#ifdef __cplusplus
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
#define SURFCAST_SUB_BRICK 4
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
  SURFCAST_VEC4 low;          // faces of the volume, source indices
  SURFCAST_VEC4 high;         // w: coarsest step, in samples of a brick's level
  SURFCAST_IVEC4 cells;       // bricks of the finest level along the axes; w: first entry in the table of cells
  SURFCAST_IVEC4 light;       // the pixels for which light is computed: first x and y in the picture, width, height
  SURFCAST_VEC4 transfer;     // x: the last bin, y: optical depth per unit of the table, z: of its colours;
                              // w: world units per unit of the depths of surfaces
  SURFCAST_IVEC4 clips;       // clip boxes of which one must contain what is seen (0: no condition), and of those that
                              // must not
};

// A brick that is drawn.
struct BrickView {
  SURFCAST_UVEC4 place;  // its first page in the list of pages, texels per row, per slice, slices per page
  SURFCAST_UVEC4 kind;   // x: level; y: last cell with four samples about it along i, j and k, 8 bits each
  SURFCAST_VEC4 scale;   // stored index = scale * source index + offset; w: bins of the transfer function per code
  SURFCAST_VEC4 offset;  // w: bin of code 0
  SURFCAST_VEC4 low;     // box of the brick, source indices
  SURFCAST_VEC4 high;
  SURFCAST_UVEC4 seen[4];  // bits of the sub-bricks, i fastest, in which something may be seen
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
#define SURFCAST_BIND_SURFACE_LIGHT 11  // vec4 per pixel of VolumeConstants::light: what surfaces add to it
// Uniform buffer:
#define SURFCAST_BIND_VOLUME 1
// Texture units of buffers:
#define SURFCAST_UNIT_CELLS 0     // uint per brick of the finest level: number of its BrickView + 1, 0: nothing is seen
#define SURFCAST_UNIT_PAGES 1     // uint per page of a brick: its first texel
#define SURFCAST_UNIT_BRICKS 3    // BrickView, ten texels
#define SURFCAST_UNIT_TRANSFER 2  // uvec4 per bin: sums of colour and extinction of the bins before it

#define SURFCAST_NO_CELL 0u

#ifdef __cplusplus
static_assert(sizeof(VolumeConstants) == 160);
static_assert(sizeof(BrickView) == 160);
}  // namespace surfcast::layout
#endif
#undef SURFCAST_VEC4
#undef SURFCAST_IVEC4
#undef SURFCAST_UVEC4

#endif
