// The buffers that the projection of every kind reads and writes.
layout(binding = SURFCAST_UNIT_SURFELS) uniform usamplerBuffer surfels;
layout(std430, binding = SURFCAST_BIND_BLOCKS) readonly buffer Blocks { BlockView blocks[]; };
layout(std430, binding = SURFCAST_BIND_CHUNKS) readonly buffer Chunks { Chunk chunks[]; };
layout(std430, binding = SURFCAST_BIND_COUNTERS) buffer CountersBuffer { Counters counters; };
layout(binding = SURFCAST_UNIT_SPLATS, rgba32ui) writeonly uniform uimageBuffer splats;
layout(binding = SURFCAST_UNIT_DISCS, rgba32ui) writeonly uniform uimageBuffer discs;
layout(binding = SURFCAST_UNIT_BOUNDS, rg32ui) writeonly uniform uimageBuffer bounds;
