#include "render/clear_blocks.h"

#include <algorithm>

#include "render/visible_parts.h"

namespace surfcast::render {
namespace {

bool shows(const model::BrickRecord& brick, const VisibleParts& visible, const glm::u32vec3& size) {
  const double low = double{brick.low};
  const double high = double{brick.high};
  const double margin = volume::kOvershoot * (high - low);
  return visible.within(low - margin, high + margin) ||
         (visible.sliced() && visible.cut(volume::brick_box(size, brick.level, brick.brick)));
}

bool may_show(const model::ModelFile& model, size_t block, const std::vector<VisibleParts>& visible) {
  const model::BrickRecord brick = model.brick(block);
  return shows(brick, visible[brick.volume], model.volumes()[brick.volume].size);
}

}  // namespace

std::vector<bool> clear_blocks(const model::ModelFile& model, const VolumeLook& look) {
  if (model.volumes().empty()) return {};
  std::vector<VisibleParts> visible;
  for (const model::Volume& volume : model.volumes())
    visible.emplace_back(look, VolumePlace{volume.size, volume.index_to_world});
  std::vector<bool> clear(model.blocks().size(), true);
  for (size_t block = clear.size(); block-- > 0;) {  // parents precede their children
    const ldc::BlockEntry& entry = model.blocks()[block];
    const bool brick = model.info().kinds[entry.kind].kind == model::kGridKind;
    if (!brick || may_show(model, block, visible)) clear[block] = false;
    if (!clear[block] && entry.parent != ldc::BlockEntry::kNoParent) clear[entry.parent] = false;
  }
  return clear;
}

}  // namespace surfcast::render
