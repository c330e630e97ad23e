// How a splat is seen through: the last word of its disc's record, which is the splat's weight in opaque pictures.
#include "include/packing.glsl"

struct Through {
  float opacity;  // above 0, at most 1
  float count;    // what a weight counts, beside those of a whole surface; of large splats a gain of 1
};

uint pack_through(Through t) { return pack_halves(vec2(t.opacity, t.count)); }

Through unpack_through(uint packed_through) {
  vec2 halves = unpack_halves(packed_through);
  return Through(halves.x, halves.y);
}
