// Packed forms of unit vectors and colours.

// Three numbers in [0, 1] as 11, 11 and 10 bits of their square roots: steps near black are as fine as 8 bit sRGB
// needs them. linear_root_table in residency/packing.h makes them.
vec3 unpack_linear_color(uint packed_color) {
  vec3 root = vec3(packed_color & 2047u, (packed_color >> 11) & 2047u, packed_color >> 22) *
              vec3(1.0 / 2047.0, 1.0 / 2047.0, 1.0 / 1023.0);
  return root * root;
}

// A unit vector, component by component, as 11, 11 and 10 bits of (n + 1) / 2: what sums of normals are made of.
uint pack_biased_normal(vec3 n) {
  uvec3 u = uvec3(round(clamp(0.5 * n + 0.5, 0.0, 1.0) * vec3(2047.0, 2047.0, 1023.0)));
  return u.x | (u.y << 11) | (u.z << 22);
}

vec3 unpack_biased_normal(uint packed_normal) {
  return vec3(packed_normal & 2047u, (packed_normal >> 11) & 2047u, packed_normal >> 22) *
         vec3(1.0 / 2047.0, 1.0 / 2047.0, 1.0 / 1023.0);
}
