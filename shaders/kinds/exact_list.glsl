// Records of other kinds than surfels in the lists of large splats. The fragment function of their kind is evaluated
// for the ray of each pixel, and takes part in the layers of the splat kernel. A record is three uvec4: two in the
// splat buffer and one in the disc buffer. The sign bit of the word that holds the radius of a large splat marks these
// records.
#include "kinds/record.glsl"

// The intersection of a pixel's ray with an item.
struct Fragment {
  float inverse_depth;  // of the visible point; 0 if the ray misses
  float occluder;       // inverse depth of the point, pushed back: everything behind it is hidden
  float weight;         // 1: the item covers the pixel
  vec3 color;           // linear light
  vec3 normal;          // unit, camera frame
};
const Fragment kNoFragment = Fragment(0.0, 0.0, 0.0, vec3(0.0), vec3(0.0));

// Generated: the fragment functions of the picture's kinds, and fragment_of, which selects one of them.
#include "kinds/fragment_of.glsl"

bool is_of_kind(int slot) { return (texelFetch(splats, 2 * slot).w & SURFCAST_KIND_RECORD) != 0u; }

Fragment fragment_at(int slot, vec2 ray) {
  uvec4 a = texelFetch(splats, 2 * slot);
  return fragment_of(a.w & ~SURFCAST_KIND_RECORD, a, texelFetch(splats, 2 * slot + 1), texelFetch(discs, slot), ray);
}

void see_fragment(Fragment f, Columns limit, inout Columns surface, inout float peak) {
  peak = max(peak, f.weight);
  bool nearer = f.inverse_depth > 0.0 && f.inverse_depth < limit[0];
  surface[0] = nearer ? max(surface[0], f.occluder) : surface[0];
}

void add_fragment(Fragment f, Columns limit, Columns surface, float unit, inout ColumnSums sums) {
  bool visible = f.inverse_depth > 0.0 && f.inverse_depth >= surface[0] && f.inverse_depth < limit[0];
  float weight = visible ? f.weight : 0.0;
  SplatValue value;
  value.one = unit;
#ifdef SURFCAST_HAS_COLOR
  value.color = f.color * unit;
#else
  value.color = (0.5 * f.normal + 0.5) * unit;
#endif
#ifdef SURFCAST_LIT_COLOR
  value.normal = (0.5 * f.normal + 0.5) * unit;
#endif
  sums_add(sums[0], value, weight);
#ifdef SURFCAST_EYE_DOME
  sums_add_depth(sums[0], unit, weight, f.inverse_depth, surface[0]);
#endif
}
