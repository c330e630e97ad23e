// Where silhouettes are: at discontinuities of the depth of the front surface. The inverse depth of a plane is affine
// on the screen, so a discontinuity is a large second difference: slopes do not count, however steep.

// True if the second difference over three pixels in a row exceeds the threshold. It must not depend on the shader.
bool bends(float before, float here, float after) {
  precise float difference = abs(before - 2.0 * here + after) * eta();
  precise float threshold = float(SURFCAST_SILHOUETTE_JUMP) * max(here, max(before, after));
  return difference > threshold;
}
