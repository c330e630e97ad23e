#include "render/sorted_items.h"

#include <algorithm>
#include <span>

namespace surfcast::render {

uint32_t number_items(ProjectionWork& work, const std::function<uint32_t(uint32_t run)>& texels_of_item) {
  uint32_t place = 0;
  for (layout::Chunk& chunk : work.chunks) {
    chunk.run.w = place;
    place += (chunk.run.z & SURFCAST_RUN_COUNT) / texels_of_item(chunk.run.z);
  }
  return place;
}

void upload_items(const RegionTask& task, const ProjectionWork& work, SplatBuffers& buffers) {
  upload(buffers.blocks, work.blocks);
  upload(buffers.chunks, work.chunks);
  if (!task.display.clipped) return;
  upload(buffers.block_displays, work.block_displays);
  upload(buffers.clips, work.clips.empty() ? std::vector<layout::ClipRange>(1) : work.clips);
}

void bind_items(const RegionTask& task, const SplatBuffers& buffers) {
  buffers.blocks.bind(SURFCAST_BIND_BLOCKS);
  buffers.chunks.bind(SURFCAST_BIND_CHUNKS);
  task.surfels->bind(SURFCAST_UNIT_SURFELS);
  if (!task.display.clipped) return;
  buffers.block_displays.bind(SURFCAST_BIND_BLOCK_DISPLAYS);
  buffers.clips.bind(SURFCAST_BIND_CLIPS);
}

std::vector<glm::uvec4> read_keys(size_t texels, const TexelBuffer& keys) {
  std::vector<glm::uvec4> read(texels);
  keys.read(std::as_writable_bytes(std::span(read)));
  return read;
}

void upload_lists(const TileLists& lists, bool lazily, StorageBuffer& tiles, TexelBuffer& entries) {
  upload(tiles, lists.tiles);
  const size_t count = lists.entries.size();
  entries.reserve(std::max<size_t>(count + count / 4, 1), lazily);
  entries.write(std::as_bytes(std::span(lists.entries)));
}

Status draw_rounds(const TileLists& lists, uint32_t entries, const std::function<Status(const ListRound&)>& draw) {
  ListRound round{static_cast<uint32_t>(lists.tiles.size()), 0};
  while (round.tiles > 0) {
    if (Status status = draw(round); !status) return status;
    round.first += entries;
    round.tiles = lists.longer_than(round.first);
  }
  return {};
}

Groups groups_of_tiles(uint32_t tiles, uint32_t lanes_of_tile, uint32_t lanes_of_group) {
  const size_t lanes = size_t{tiles} * lanes_of_tile;
  return {(lanes + lanes_of_group - 1) / lanes_of_group, {}};
}

}  // namespace surfcast::render
