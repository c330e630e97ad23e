// Selects the surfels of a block for the requested spacing. A block has its own surfels and levels of merged surfels
// (residency/merge_surfels.h), all with radii that follow from their spacing. The coarsest level that is fine enough is
// drawn, decided per surfel. A merged surfel is drawn if its radius is at most the requested one at its position. Any
// surfel is drawn only if the surfel that it is merged to is not.

// Radius at o (camera frame) of an evenly sampled surface whose projected spacing is the requested one, in the measure
// of selection/block_hull.h; 0 if all surfels are requested.
float wanted_radius(vec3 o) { return o.z > 0.0 ? frame.filter_.w * o.z * o.z * inversesqrt(dot(o, o)) : 0.0; }

// `merged`: radius of the surfel to which this one is merged.
bool fits_spacing(uint kinds, float radius, float merged, float wanted) {
  bool fine_enough = (kinds & SURFCAST_RUN_FINEST) != 0u || radius <= wanted;
  bool coarse_enough = (kinds & SURFCAST_RUN_COARSEST) != 0u || merged > SURFCAST_SPACING_SLACK * wanted;
  return fine_enough && coarse_enough;
}
