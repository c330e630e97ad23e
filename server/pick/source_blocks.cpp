#include "pick/source_blocks.h"

#include <vector>

namespace surfcast::pick {

Result<std::shared_ptr<const kinds::SourceBlock>> SourceBlocks::get(const model::ModelFile& model, uint32_t block) {
  const std::pair key(model.id(), block);
  {
    const std::lock_guard lock(mutex_);
    if (auto found = cache_.find(key)) return found;
  }
  const Result<std::vector<uint32_t>> numbers = kinds::find_kinds(model, kinds_);
  if (!numbers) return fail(numbers.error());
  const kinds::Kind& kind = *kinds_[(*numbers)[model.blocks()[block].kind]];
  Result<std::shared_ptr<const kinds::SourceBlock>> decoded = kind.decode(model, block);
  if (!decoded) return decoded;
  const std::lock_guard lock(mutex_);
  cache_.put(key, *decoded, (*decoded)->bytes());
  return decoded;
}

}  // namespace surfcast::pick
