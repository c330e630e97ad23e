// Records of other kinds than surfels in the lists of large splats: what a kind's own function says of a pixel's ray
// takes part in the rounds of the splat kernel. A record is three uvec4: two in the buffer of splats and one in that of
// discs. The sign of the word that is a large splat's radius tells them apart.
#include "kinds/record.glsl"

// What the ray of a pixel meets of a record.
struct Fragment {
  float inverse_depth;  // of the point that is seen; 0: the ray meets nothing
  float occluder;       // inverse depth behind which everything is hidden: a little smaller
  float weight;         // 1 covers the pixel
  vec3 color;           // linear light
  vec3 normal;          // unit, camera frame
};
const Fragment kNoFragment = Fragment(0.0, 0.0, 0.0, vec3(0.0), vec3(0.0));

// The kinds of the picture, and a choice among them.
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
