// Buffer layouts and bindings that C++ and GLSL share: one declaration, read by both (sizes are asserted in
// render/frame_layout_check.cpp). A struct holds only 16-byte members, so std140, std430 and C++ agree on it.
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

// Size of a screen tile in pixels: the unit of binning and of the splat kernel. Smaller ones hold less that lies beside a
// splat, larger ones are entered in fewer lists.
#define SURFCAST_TILE_WIDTH 4
#define SURFCAST_TILE_HEIGHT 4
// Size in pixels of a work group of passes that go over pixels alone: a warp on hardware.
#define SURFCAST_BLOCK_WIDTH 8
#define SURFCAST_BLOCK_HEIGHT 4
// Lanes of a work group of the passes over silhouettes.
#define SURFCAST_SILHOUETTE_LANES 32
// Surfels that one work group projects; runs of a block are cut into chunks of this many.
#define SURFCAST_CHUNK 128
// Splats that a tile may have before its splats are thinned out (see include/thinning.glsl).
#define SURFCAST_TILE_CAPACITY 3072
// Splats that a tile may have after that, before all its splats are sampled alike.
#define SURFCAST_TILE_CAPACITY_LIMIT 4000
// Splats between two carries of the fixed-point sums (see splat.comp).
#define SURFCAST_CARRY_INTERVAL 32

// Constants of one region of one frame. Camera frame: x right, y up, z forward, origin at the eye.
struct FrameConstants {
  SURFCAST_VEC4 right;       // world to camera rotation, row x; w: eta, pixels per unit of tangent
  SURFCAST_VEC4 up;          // row y; w: half the picture's width, pixels
  SURFCAST_VEC4 forward;     // row z; w: half the picture's height, pixels
  SURFCAST_IVEC4 region;     // first pixel x, y and size of the region, pixels from the top left of the picture
  SURFCAST_IVEC4 tiles;      // tiles across, tiles down, tiles in all, splats that the record buffer holds
  SURFCAST_VEC4 filter_;     // prefilter variance, visibility prefilter variance (pixels squared), factor of every
                             // surfel's weight, radius of the wanted spacing at distance 1 straight ahead
  SURFCAST_VEC4 background;  // linear light
  SURFCAST_IVEC4 flags;      // x: back faces are culled, y: per-surfel weights, z: splats that a tile is thinned out to
                             // (0: not at all), w: those that cover much, too
};

// One visible block (see shared/surfel_layout.h).
struct BlockView {
  SURFCAST_VEC4 origin;  // where position code 0 lies, relative to the eye, camera coordinates, world units
  SURFCAST_VEC4 step;    // world units of a step of the position codes, along the world's axes
  SURFCAST_VEC4 scale;   // log2 of the largest radius, octaves per step, the same of the weights
};

// What the options of a picture ask of one block, for builds of the projection that have them; as many as BlockViews.
struct BlockDisplay {
  SURFCAST_VEC4 ramp;    // x: place on the colour map (0 to 1) of code 0 of the attribute or height, y: of a step
  SURFCAST_IVEC4 clips;  // x: first of its clip ranges, y: so many of which a surfel must be in any (0: it need not),
                         // z: and so many that follow of which it must be in none
};

// The position codes of a block that lie in a clip box, from `low` to `high`.
struct ClipRange {
  SURFCAST_UVEC4 low;
  SURFCAST_UVEC4 high;
};

// What the options of a picture ask of all blocks.
struct DisplayConstants {
  SURFCAST_UVEC4 hidden[2];  // 256 bits, by code of the classification: 1 where it is not drawn
  SURFCAST_IVEC4 axis;       // x: the vertical one, 0 to 2; y: last entry of the colour table
};

// What eye-dome lighting asks for.
struct EyeDomeConstants {
  SURFCAST_VEC4 shade;    // strength, radius in pixels, unused, unused
  SURFCAST_IVEC4 region;  // the pixels that are wanted: first x and y counted from the drawn region's, width, height
};

// A run of at most SURFCAST_CHUNK surfels of one block: block index, first texel, surfels and what they are, a number
// that no other run of the model shares (modulo 2^32).
struct Chunk {
  SURFCAST_UVEC4 run;
};
#define SURFCAST_RUN_COUNT 0xffffu
#define SURFCAST_RUN_FINEST 0x10000u    // surfels of the block itself, not merged ones
#define SURFCAST_RUN_COARSEST 0x20000u  // not merged any further
#define SURFCAST_RUN_PAIRS 0x40000u     // each two, from the first texel on, are merged to one of another run
// A merged surfel takes over from its pair a little early, so that rounding never leaves both of them out.
#define SURFCAST_SPACING_SLACK 0.99

// What the projection counts.
struct Counters {
  SURFCAST_UVEC4 counts;      // small splats, large splats, entries of all tile lists, of the longest (both lists of a tile)
  SURFCAST_UVEC4 lengths[2];  // tiles with at least so many entries, for each of SURFCAST_LIST_LENGTHS
};
// Powers of two, which set tiles apart by what they cost (see render/tile_spans.h).
#define SURFCAST_LIST_LENGTHS 1, 4, 16, 64, 256, 512, 1024, 2048

// Location of the uniform `first_group` of passes that are dispatched in batches: work groups, or rows of them, before
// the batch.
#define SURFCAST_UNIFORM_FIRST_GROUP 0
// Of the splat kernel's `span`: first tile, end and tiles of a work group, in the order of tiles.
#define SURFCAST_UNIFORM_SPAN 1

// Bindings. Storage buffers:
#define SURFCAST_BIND_BLOCK_DISPLAYS 0  // BlockDisplay per block
#define SURFCAST_BIND_CLIPS 1  // ClipRange, those of each block side by side
#define SURFCAST_BIND_BLOCKS 3
#define SURFCAST_BIND_CHUNKS 4
#define SURFCAST_BIND_COUNTERS 5
#define SURFCAST_BIND_TILE_COUNT 6   // uint per tile and list: entries; small lists first, then large lists
#define SURFCAST_BIND_TILE_OFFSET 7  // uint per tile and list: first entry
#define SURFCAST_BIND_TILE_DEMAND 8   // uint per tile: entries of both its lists, as counted before thinning
#define SURFCAST_BIND_PICTURE 9
#define SURFCAST_BIND_TILE_ORDER 14  // uint per tile: the tiles, those with the longest lists first
#define SURFCAST_BIND_NEXT_TILES 15       // uint per work group of the splat kernel: tiles that its lanes have begun
#define SURFCAST_BIND_LIGHT 2   // vec4 per pixel: linear light and coverage before eye-dome lighting
#define SURFCAST_BIND_DEPTH 10  // vec2 per pixel: log2 of the visible surface's depth, coverage that it is the mean of
#define SURFCAST_BIND_FRONTS 11           // float per pixel: what silhouettes are found by, see silhouettes.comp
#define SURFCAST_BIND_SILHOUETTES 12      // count, then parts of tiles, in any order: tile, its pixels by rows from bit 0 on
// Uniform buffers:
#define SURFCAST_BIND_FRAME 0
#define SURFCAST_BIND_DISPLAY 1
#define SURFCAST_BIND_EYE_DOME 2
// Image and texture units of the buffers that are larger than a storage block may be:
#define SURFCAST_UNIT_SPLATS 0      // two uvec4 per splat
#define SURFCAST_UNIT_DISCS 1       // uvec4 per small splat: the opaque disc of visibility splatting
#define SURFCAST_UNIT_BOUNDS 2      // uvec2 per splat: its tiles, for binning
#define SURFCAST_UNIT_LISTS 3       // uint per entry: splat
#define SURFCAST_UNIT_NORMALS 4     // uint per splat: packed camera space normal, when a lit scene has colour too
#define SURFCAST_UNIT_SURFELS 5     // uvec4 per surfel, see shared/surfel_layout.h
#define SURFCAST_UNIT_SRGB 6        // uint per 8 bit sRGB value: the root of its linear light in 11 and 10 bits
#define SURFCAST_UNIT_ATTRIBUTES 7  // uint per surfel: 16 bits of intensity, 8 of classification
#define SURFCAST_UNIT_COLORS 8      // uint per entry of a colour table: linear light as in a splat's record

#ifdef __cplusplus
static_assert(sizeof(FrameConstants) == 128);
static_assert(sizeof(BlockView) == 48);
static_assert(sizeof(BlockDisplay) == 32);
static_assert(sizeof(ClipRange) == 32);
static_assert(sizeof(DisplayConstants) == 48);
static_assert(sizeof(Chunk) == 16);
static_assert(sizeof(Counters) == 48);
}  // namespace surfcast::layout
#endif
#undef SURFCAST_VEC4
#undef SURFCAST_IVEC4
#undef SURFCAST_UVEC4

#endif
