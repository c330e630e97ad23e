// Buffer layouts and bindings that C++ and GLSL share (sizes are asserted in render/frame_layout_check.cpp). Structs
// have only 16-byte members, so std140, std430 and C++ agree on their layout.
#ifndef SURFCAST_SHARED_FRAME_LAYOUT_H
#define SURFCAST_SHARED_FRAME_LAYOUT_H

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

// Size of a screen tile in pixels: the unit of binning and of the splat kernel. A smaller tile lists fewer splats that
// miss some of its pixels. A larger tile needs fewer list entries per splat.
#define SURFCAST_TILE_WIDTH 4
#define SURFCAST_TILE_HEIGHT 4
// Work group size in pixels of passes over pixels only: one warp on GPUs.
#define SURFCAST_BLOCK_WIDTH 8
#define SURFCAST_BLOCK_HEIGHT 4
// Lanes of a work group of the silhouette passes, unless the shape of the kernels says otherwise
// (render/programs.h).
#ifndef SURFCAST_SILHOUETTE_LANES
#define SURFCAST_SILHOUETTE_LANES 32
#endif
// Texels (surfels) that one work group projects. Runs of a block are divided into chunks of this size.
#define SURFCAST_CHUNK 128
// Entries of a list from which on a work group draws its tile: one of SURFCAST_LIST_LENGTHS. A lane alone would come
// near the limit of software GL for its loops (see render/tile_spans.h).
#define SURFCAST_LONG_LIST 3584
// Surfaces behind each other that a pixel shows, at most, and entries that a lane takes of a long list that it shares,
// for all of these surfaces together: in two passes they are three quarters of what software GL allows.
#define SURFCAST_MOST_SURFACES 8
#define SURFCAST_ENTRIES_OF_LANE 24000
// Depth slices into which the list of a tile may be divided. A list entry and the first tile of a splat hold the number
// of a slice in the bits above SURFCAST_SLICE_SHIFT; below it are a splat's index, and a tile's row and column.
#define SURFCAST_SLICES 16
#define SURFCAST_LEVELS 256  // of depth, for all slices together
#define SURFCAST_SLICE_SHIFT 26
// Rows of tiles that one lane bins of a large splat.
#define SURFCAST_BAND_ROWS 120
// Splats between two carries of the fixed-point sums (see include/fixed_sum.glsl).
#define SURFCAST_CARRY_INTERVAL 32

// Constants of one region of one frame. Camera frame: x right, y up, z forward, origin at the eye.
struct FrameConstants {
  SURFCAST_VEC4 right;       // world to camera rotation, row x; w: eta, pixels per unit of tangent
  SURFCAST_VEC4 up;          // row y; w: half the picture's width, pixels
  SURFCAST_VEC4 forward;     // row z; w: half the picture's height, pixels
  SURFCAST_IVEC4 region;     // first pixel x, y (from the top left of the picture) and size of the region, pixels
  SURFCAST_IVEC4 tiles;      // tiles across, tiles down, number of tiles, capacity of the record buffer in splats
  SURFCAST_VEC4 filter_;     // prefilter variance, visibility prefilter variance (pixels squared), factor of every
                             // surfel's weight, surfel radius of the requested spacing at distance 1 on the view axis
  SURFCAST_VEC4 background;  // linear light; w: factor of the opacities of Gaussians
  SURFCAST_IVEC4 flags;      // x: cull back faces, y: per-surfel weights, z: faces that meet add their coverages
  SURFCAST_IVEC4 slices;     // depth slices of a tile's list, see include/depth_slices.glsl: x: number, y: bits of the
                             // inverse depth at which the second level begins, z: bits of the levels per step of these
};

// One visible block (see shared/surfel_layout.h).
struct BlockView {
  SURFCAST_VEC4 origin;  // position of code 0 relative to the eye, camera axes, world units
  SURFCAST_VEC4 step;    // world units per step of the position codes, along the world's axes
  SURFCAST_VEC4 scale;   // surfels: log2 of the largest radius, octaves per step; the same for the weights; other
                         // kinds: see BlockHeader::scale
};

// Per-block parameters of the display options, for variants of the projection that use them; one for each BlockView.
struct BlockDisplay {
  SURFCAST_VEC4 ramp;    // x: position on the colour map (0 to 1) of code 0 of the attribute or height, y: of one step
  SURFCAST_IVEC4 clips;  // x: first clip range, y: number of ranges of which one must contain a surfel (0: no
                         // condition), z: number of subsequent ranges that must not contain it
};

// The position codes of a block within a clip box, from `low` to `high` (inclusive).
struct ClipRange {
  SURFCAST_UVEC4 low;
  SURFCAST_UVEC4 high;
};

// Parameters of the display options that apply to all blocks.
struct DisplayConstants {
  SURFCAST_UVEC4 hidden[2];  // 256 bits, indexed by classification code: 1 if hidden
  SURFCAST_IVEC4 axis;       // x: vertical axis, 0 to 2; y: last entry of the colour table
};

// How surfels are seen through, in pictures in which ghosts or classes have opacities.
struct ThroughConstants {
  SURFCAST_VEC4 ghost;        // x: factor of what clip boxes hide
  SURFCAST_VEC4 classes[64];  // factor of each class, four in a vector
};

// Parameters of eye-dome lighting.
struct EyeDomeConstants {
  SURFCAST_VEC4 shade;    // strength, radius in pixels, unused, unused
  SURFCAST_IVEC4 region;  // requested pixels: first x and y relative to the drawn region, width, height
};

// A run of at most SURFCAST_CHUNK texels (surfels) of one block: block index, first texel, number of texels with the
// flags below, and an ID of the first texel that is unique within the model (modulo 2^32). The flags are those of
// surfels.
struct Chunk {
  SURFCAST_UVEC4 run;
};
#define SURFCAST_RUN_COUNT 0xffffu
#define SURFCAST_RUN_FINEST 0x10000u      // surfels of the block itself, not merged ones
#define SURFCAST_RUN_COARSEST 0x20000u    // not merged any further
#define SURFCAST_RUN_PAIRS 0x40000u       // each pair, from the first texel on, is merged to one surfel of another run
#define SURFCAST_RUN_SCATTER 0x80000u     // scatter, in variants of the projection that draw it
#define SURFCAST_RUN_CURVED 0x100000u     // surfels have two texels: the second one is their curvature
#define SURFCAST_RUN_TWO_SIDED 0x200000u  // normals do not tell front from back
#define SURFCAST_RUN_COARSE 0x800000u     // of a block that stands in for finer ones: need not be exact
// Merged surfels replace their pair slightly early, because rounding could otherwise drop both.
#define SURFCAST_SPACING_SLACK 0.99

// Counters of the projection.
struct Counters {
  SURFCAST_UVEC4 counts;      // small splats, large splats (with records of other kinds), list entries of all tiles,
                              // most entries of a tile
  SURFCAST_UVEC4 lengths[2];  // tiles with at least this many entries, for each of SURFCAST_LIST_LENGTHS
};
// Numbers that classify tiles by cost (see render/tile_spans.h): bounds of the classes of bin_offsets.comp.
#define SURFCAST_LIST_LENGTHS 1, 4, 16, 64, 256, 512, 1024, SURFCAST_LONG_LIST

// Location of the uniform `first_group` of passes that are dispatched in batches: the number of work groups, or rows of
// work groups, before the batch.
#define SURFCAST_UNIFORM_FIRST_GROUP 0
// Location of `span` of the splat kernel: first tile, end, and tiles per work group, in tile order.
#define SURFCAST_UNIFORM_SPAN 1

// Bindings. Storage buffers:
#define SURFCAST_BIND_BLOCK_DISPLAYS 0  // BlockDisplay per block
#define SURFCAST_BIND_CLIPS 1           // ClipRange, contiguous for each block
#define SURFCAST_BIND_BLOCKS 3
#define SURFCAST_BIND_CHUNKS 4
#define SURFCAST_BIND_COUNTERS 5
#define SURFCAST_BIND_TILE_COUNT 6   // uint per tile and slice, see slices.comp; large splats follow the last slice
#define SURFCAST_BIND_TILE_OFFSET 7  // uint per tile: first entry
#define SURFCAST_BIND_UNFINISHED 8   // number of columns that were handed over, see include/unfinished.glsl
#define SURFCAST_BIND_PICTURE 9
#define SURFCAST_BIND_TILE_ORDER 14   // uint per tile: tiles in descending order of list length
#define SURFCAST_BIND_NEXT_TILES 15   // uint per work group of the splat kernel: tiles started by its lanes
#define SURFCAST_BIND_LIGHT 2         // vec4 per pixel: linear light and coverage before eye-dome lighting
#define SURFCAST_BIND_DEPTH 10        // vec2 per pixel: mean log2 of the visible surface's depth, coverage
#define SURFCAST_BIND_SHOWN_DEPTHS 3  // vec2 per pixel: inverse depths of the front and of the opaque surface
#define SURFCAST_BIND_FRONTS 11       // float per pixel: inverse depth of the front surface, see silhouettes.comp
#define SURFCAST_BIND_SILHOUETTES 12  // pixels at silhouettes, see include/silhouette_list.glsl
// Uniform buffers:
#define SURFCAST_BIND_FRAME 0
#define SURFCAST_BIND_DISPLAY 1
#define SURFCAST_BIND_EYE_DOME 2
#define SURFCAST_BIND_THROUGH 4
// Image and texture units of buffers that exceed the size limit of storage blocks:
#define SURFCAST_UNIT_SPLATS 0      // two uvec4 per splat
#define SURFCAST_UNIT_DISCS 1       // uvec4 per small splat: its opaque disc; or third uvec4 of a kind's record
#define SURFCAST_UNIT_BOUNDS 2      // uvec2 per splat: its range of tiles, for binning
#define SURFCAST_UNIT_LISTS 3       // uint per entry: splat index and depth slice
#define SURFCAST_UNIT_NORMALS 4     // uint per splat: packed camera space normal, in lit scenes with colour
#define SURFCAST_UNIT_SURFELS 5     // uvec4 per texel of a block; surfels: see shared/surfel_layout.h
#define SURFCAST_UNIT_SRGB 6        // uint per 8 bit sRGB value: root of its linear light in 11 and in 10 bits
#define SURFCAST_UNIT_ATTRIBUTES 7  // uint per surfel: 16 bits of intensity, 8 of classification, 8 of opacity
#define SURFCAST_UNIT_REACHES 6     // uint per list entry: what its splat may reach, see include/splat_bounds.glsl
#define SURFCAST_UNIT_UNFINISHED 7  // columns that were handed over, in the passes that draw
#define SURFCAST_UNIT_COLORS 8      // uint per entry of a colour table: linear light as in a splat record

#ifdef __cplusplus
static_assert(sizeof(FrameConstants) == 144);
static_assert(sizeof(BlockView) == 48);
static_assert(sizeof(BlockDisplay) == 32);
static_assert(sizeof(ClipRange) == 32);
static_assert(sizeof(DisplayConstants) == 48);
static_assert(sizeof(ThroughConstants) == 1040);
static_assert(sizeof(Chunk) == 16);
static_assert(sizeof(Counters) == 48);
}  // namespace surfcast::layout
#endif
#undef SURFCAST_VEC4
#undef SURFCAST_IVEC4
#undef SURFCAST_UVEC4

#endif
