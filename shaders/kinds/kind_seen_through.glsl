// Adds a fragment of another kind than surfels to a surface that is seen through.
void add_kind(Fragment f, float limit, float surface, float reference, float unit, bool medium,
              inout SurfaceSums sums) {
  SurfaceValue value = surface_value(0u, 0, Through(frame.background.w, 1.0), unit, medium);
#ifdef SURFCAST_HAS_COLOR
  value.seen.color = f.color * value.opacity;
#else
  value.seen.color = (0.5 * f.normal + 0.5) * value.opacity;
#endif
#ifdef SURFCAST_LIT_COLOR
  value.seen.normal = (0.5 * f.normal + 0.5) * value.opacity;
#endif
  bool visible = f.inverse_depth > 0.0 && f.inverse_depth >= surface && f.inverse_depth < limit;
  float weight = visible ? f.weight : 0.0;
  surface_add(sums, value, weight);
#ifdef SURFCAST_EYE_DOME
  sums_add_depth(sums.seen, unit, weight, visible ? f.inverse_depth : reference, reference);
#endif
}
