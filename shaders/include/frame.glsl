layout(std140, binding = SURFCAST_BIND_FRAME) uniform Frame { FrameConstants frame; };

float eta() { return frame.right.w; }
vec2 half_picture() { return vec2(frame.up.w, frame.forward.w); }

// Conversion between pixel positions (from the top left of the picture) and the x and y of a ray at z = 1.
vec2 ray_of_pixel(vec2 pixel) { return (pixel - half_picture()) * vec2(1.0, -1.0) / eta(); }
vec2 pixel_of_ray(vec2 ray) { return half_picture() + eta() * vec2(ray.x, -ray.y); }

// `steps`, the length of a loop, hidden from the compiler, which would unroll the loop. In software, all lanes would
// then run through all steps, even where none needs them, and long code would take seconds to compile.
int not_unrolled(int steps) { return frame.region.z > 0 ? steps : 0; }
