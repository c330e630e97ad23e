// Which surfels of a block are drawn at the wanted spacing. A block has its own surfels and levels of merged ones
// (residency/merge_surfels.h), all with radii that follow from their spacing. The coarsest that are fine enough are
// drawn, decided one by one: what is merged is drawn if its radius is not above the wanted one where it stands, and a
// surfel only if the one that it is merged to is not drawn.

// Radius of an evenly sampled surface at o (camera frame) whose projected spacing is the wanted one, by the measure of
// selection/block_hull.h; 0 where every surfel is wanted.
float wanted_radius(vec3 o) { return o.z > 0.0 ? frame.filter_.w * o.z * o.z * inversesqrt(dot(o, o)) : 0.0; }

// `merged`: radius of what the surfel is merged to.
bool fits_spacing(uint kinds, float radius, float merged, float wanted) {
  bool fine_enough = (kinds & SURFCAST_RUN_FINEST) != 0u || radius <= wanted;
  bool coarse_enough = (kinds & SURFCAST_RUN_COARSEST) != 0u || merged > SURFCAST_SPACING_SLACK * wanted;
  return fine_enough && coarse_enough;
}
