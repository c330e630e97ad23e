#include "pick/source_blocks.h"

#include <variant>
#include <vector>

namespace surfcast::pick {
namespace {

template <typename T>
size_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

size_t bytes_of(const model::DecodedBlock& block) {
  size_t bytes = bytes_of(block.indices) + bytes_of(block.normals) + bytes_of(block.radii) + bytes_of(block.weights) +
                 bytes_of(block.colors);
  for (const surfel::ScalarAttribute& scalar : block.scalars) {
    bytes += std::visit([](const auto& values) { return bytes_of(values); }, scalar.values);
  }
  return bytes;
}

}  // namespace

Result<std::shared_ptr<const model::DecodedBlock>> SourceBlocks::get(const model::ModelFile& model, uint32_t block) {
  const std::pair key(model.id(), block);
  {
    const std::lock_guard lock(mutex_);
    if (auto found = cache_.find(key)) return found;
  }
  Result<model::DecodedBlock> decoded = model.decode(block);
  if (!decoded) return fail(std::move(decoded.error()));
  auto shared = std::make_shared<const model::DecodedBlock>(std::move(*decoded));
  const std::lock_guard lock(mutex_);
  cache_.put(key, shared, bytes_of(*shared));
  return shared;
}

}  // namespace surfcast::pick
