// The depth of what stands for a pixel where things are seen through: that at which half of the light is lost, as for
// picks. Where less is lost, the mean depth of what takes it.
#ifdef SURFCAST_KEEPS_FRONTS
layout(std430, binding = SURFCAST_BIND_FRONTS) buffer Fronts { float fronts[]; };

const float kHalfLost = 0.5;
const float kFaintest = 1.0 / 32.0;  // of the light: what takes less has no depth

// From front to back: what is at this inverse depth lets `after` of the light through, of which `before` reached it
// (magnitudes). `front`: 0 at first; the inverse depth once it is known; till then minus the sum of the depths, weighted
// by what is lost there.
float pass_front(float front, float before, float after, float inverse_depth) {
  if (front > 0.0) return front;
  return abs(after) <= kHalfLost ? inverse_depth : front - (abs(before) - abs(after)) / max(inverse_depth, 1e-30);
}

// The inverse depth of a pixel that lets `clear` of the light through; 0: nothing is seen.
float end_front(float front, float clear) {
  float lost = 1.0 - abs(clear);
  return front >= 0.0 ? front : lost >= kFaintest ? -lost / front : 0.0;
}
#endif
