#include "pick/source_blocks.h"

#include <vector>

#include "selection/block_hull.h"

namespace surfcast::pick {

Result<std::shared_ptr<const kinds::SourceBlock>> SourceBlocks::get(const model::ModelFile& model, uint32_t block) {
  const std::pair key(model.id(), block);
  {
    const std::lock_guard lock(mutex_);
    if (auto found = cache_.find(key)) return found;
  }
  const Result<std::vector<uint32_t>> numbers = kinds::find_kinds(model, kinds_);
  if (!numbers) return fail(numbers);
  const kinds::Kind& kind = *kinds_[(*numbers)[model.blocks()[block].kind]];
  Result<std::shared_ptr<const kinds::SourceBlock>> decoded = kind.decode(model, block);
  if (!decoded) return decoded;
  const std::lock_guard lock(mutex_);
  cache_.put(key, *decoded, (*decoded)->bytes());
  return decoded;
}

SourceBlocks::Hulls SourceBlocks::hulls(const model::ModelFile& model) {
  {
    const std::lock_guard lock(mutex_);
    if (auto found = hulls_.find(model.id())) return found;
  }
  auto made = std::make_shared<const std::vector<selection::BlockHull>>(selection::block_hulls(model.tree()));
  const std::lock_guard lock(mutex_);
  hulls_.put(model.id(), made, 1);
  return made;
}

SourceBlocks::Hulls hulls_of(const model::ModelFile& model, const kinds::PickQuery& query, SourceBlocks& source) {
  SourceBlocks::Hulls hulls = source.hulls(model);
  if (!(query.reach > 0)) return hulls;
  auto reaching = selection::with_reach(*hulls, query.reach / kReachInRadii);
  return std::make_shared<const std::vector<selection::BlockHull>>(std::move(reaching));
}

}  // namespace surfcast::pick
