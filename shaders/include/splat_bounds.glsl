// What lists know of a small splat: the first and the last tile of the region that list it, the pixels that it may
// touch there, samples included, and the levels of depth that it may reach (see include/depth_slices.glsl).
struct SplatBounds {
  uvec2 first_tile;
  uvec2 last_tile;
  uvec2 low;   // pixel, in the first tile or, along either axis, in the one before it
  uvec2 high;  // pixel, in the last tile or, along either axis, in the one after it
  uint nearest;
  uint farthest;
};

const uvec2 kTileSize = uvec2(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT);

// A region has at most 2048 pixels a side: 11 bits for a pixel, and one that says whether its tile is not the one that
// lists the splat.
const uint kPixelBits = 11u;
const uint kPixelMask = (1u << kPixelBits) - 1u;

uint pack_pixel(uvec2 pixel, uvec2 tile, uint level) {
  uvec2 beyond = uvec2(notEqual(pixel / kTileSize, tile));
  return pixel.x | (pixel.y << kPixelBits) | (beyond.x << 22) | (beyond.y << 23) | (level << 24);
}

uvec2 pack_bounds(SplatBounds b) {
  return uvec2(pack_pixel(b.low, b.first_tile, b.nearest), pack_pixel(b.high, b.last_tile, b.farthest));
}

uvec2 unpack_pixel(uint packed_pixel) { return uvec2(packed_pixel, packed_pixel >> kPixelBits) & kPixelMask; }
uvec2 unpack_beyond(uint packed_pixel) { return uvec2(packed_pixel >> 22, packed_pixel >> 23) & 1u; }

SplatBounds unpack_bounds(uvec2 p) {
  uvec2 low = unpack_pixel(p.x);
  uvec2 high = unpack_pixel(p.y);
  return SplatBounds(low / kTileSize + unpack_beyond(p.x), high / kTileSize - unpack_beyond(p.y), low, high, p.x >> 24,
                     p.y >> 24);
}

// The reach of a splat in a tile. Bits 0 to 15: pixels of the tile by rows that it may
// touch, bits 16 to 23 and 24 to 31: nearest and farthest level.
uint reach_in_tile(SplatBounds b, uvec2 tile) {
  uvec2 corner = tile * kTileSize;
  uvec2 low = max(b.low, corner) - corner;
  uvec2 high = min(b.high, corner + kTileSize - 1u) - corner;
  uint columns = ((2u << high.x) - (1u << low.x)) * 0x1111u;
  uint rows = (2u << (high.y * kTileSize.x + kTileSize.x - 1u)) - (1u << (low.y * kTileSize.x));
  return (columns & rows) | (b.nearest << 16) | (b.farthest << 24);
}
