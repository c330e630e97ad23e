// Light of the nearest hits. Lights are far away, in the camera frame; without any there is a headlight.
layout(std140, binding = SURFCAST_BIND_GLYPH_LIGHTING) uniform Lighting { GlyphLighting lighting; };
layout(std430, binding = SURFCAST_BIND_GLYPH_LIGHTS) readonly buffer Lights { GlyphLight lights[]; };

const float kAmbient = 0.1;  // of the headlight

// `n`: unit, `d`: of the ray, z = 1.
vec3 lit(vec3 color, vec3 n, vec3 d) {
  vec3 ray = normalize(d);
  if (lighting.size.x < 0) return color;
  if (lighting.size.x == 0) return color * (kAmbient + (1.0 - kAmbient) * min(abs(dot(n, ray)), 1.0));
  float diffuse = lighting.terms.x;
  float specular = 0.0;
  for (int i = 0; i < lighting.size.x; ++i) {
    vec4 light = lights[i].direction;
    float cosine = dot(n, light.xyz);
    if (cosine <= 0.0) continue;
    diffuse += light.w * cosine;
    float shine = max(dot(n, normalize(light.xyz - ray)), 0.0);
    specular += light.w * pow(max(shine, 1e-6), lighting.terms.z);
  }
  return min(diffuse * color + lighting.terms.y * specular, 1.0);
}
