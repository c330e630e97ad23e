// The pixels at silhouettes. Pixels of tiles without large splats come in parts, from the start of the list on: as many
// pixels of a tile as a lane of supersample.comp draws at once. Pixels of tiles with large splats come one by one, from
// the end of the list on. There is room for every pixel of every tile.
layout(std430, binding = SURFCAST_BIND_SILHOUETTES) buffer Silhouettes {
  uvec2 silhouette_counts;   // parts, single pixels
  uvec2 silhouette_parts[];  // tile, bit mask of its pixels by rows
};

uint silhouettes_end() { return uint(frame.tiles.z * SURFCAST_TILE_WIDTH * SURFCAST_TILE_HEIGHT); }
