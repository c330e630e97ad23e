#include "render/clear_blocks.h"

#include "render/transfer_function.h"

namespace surfcast::render {
namespace {

bool shows(const model::BrickRecord& brick, const TransferFunction& transfer) {
  const double low = double{brick.low};
  const double high = double{brick.high};
  const double margin = volume::kOvershoot * (high - low);
  return transfer.visible_within(low - margin, high + margin);
}

}  // namespace

std::vector<bool> clear_blocks(const model::ModelFile& model, const VolumeLook& look) {
  if (model.volumes().empty()) return {};
  const TransferFunction transfer(look.points, 1);  // whether there is an opacity does not depend on the spacing
  std::vector<bool> clear(model.blocks().size(), true);
  for (size_t block = clear.size(); block-- > 0;) {  // parents precede their children
    const ldc::BlockEntry& entry = model.blocks()[block];
    const bool brick = model.info().kinds[entry.kind].kind == model::kGridKind;
    if (!brick || shows(model.brick(block), transfer)) clear[block] = false;
    if (!clear[block] && entry.parent != ldc::BlockEntry::kNoParent) clear[entry.parent] = false;
  }
  return clear;
}

}  // namespace surfcast::render
