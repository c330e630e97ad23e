// The pixels at silhouettes. Pixels of tiles without large splats come in parts, from the start of the list on: as many
// pixels of a tile as a lane of supersample.comp draws at once. Pixels of tiles with large splats come one by one, from
// the end of the list on. There is room for every pixel of every tile. Pixels of tiles with long lists come in a second
// list of this form.
layout(std430, binding = SURFCAST_BIND_SILHOUETTES) buffer Silhouettes {
  uvec4 silhouette_counts;   // parts, single pixels; the same in tiles with long lists
  uvec2 silhouette_parts[];  // tile, bit mask of its pixels by rows
};

// First part and end of a list.
uint silhouettes_begin(bool in_long_lists) {
  return in_long_lists ? uint(frame.tiles.z * SURFCAST_TILE_WIDTH * SURFCAST_TILE_HEIGHT) : 0u;
}
uint silhouettes_end(bool in_long_lists) { return silhouettes_begin(in_long_lists) + silhouettes_begin(true); }
