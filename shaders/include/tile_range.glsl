// The first and the last pixel of the region whose centres (at +0.5) are in [low, high].
uvec4 pixel_range(vec2 low, vec2 high, out bool outside) {
  vec2 first = ceil(low - 0.5 - vec2(frame.region.xy));
  vec2 last = floor(high - 0.5 - vec2(frame.region.xy));
  vec2 size = vec2(frame.region.zw);
  outside = any(greaterThan(first, last)) || any(lessThan(last, vec2(0.0))) || any(greaterThanEqual(first, size)) ||
            any(isnan(low + high));
  return uvec4(clamp(first, vec2(0.0), size - 1.0), clamp(last, vec2(0.0), size - 1.0));
}

// The range of tiles that a rectangle of pixels touches: its first and its last tile, with 16 bits per coordinate.
uvec2 tile_range(vec2 low, vec2 high, out bool outside) {
  uvec4 pixels = pixel_range(low, high, outside);
  uvec2 tile = uvec2(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT);
  uvec2 a = pixels.xy / tile;
  uvec2 b = pixels.zw / tile;
  return uvec2(a.x | (a.y << 16), b.x | (b.y << 16));
}
