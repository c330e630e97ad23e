#include "pick/leaf_numbers.h"

namespace surfcast::pick {

std::vector<uint64_t> leaf_numbers(const model::ModelFile& model) {
  std::vector<uint64_t> numbers;
  numbers.reserve(model.blocks().size());
  uint64_t next = 0;
  for (uint32_t block = 0; block < model.blocks().size(); ++block) {
    numbers.push_back(next);
    if (model.tree().children(block).count == 0) next += model.blocks()[block].items;
  }
  return numbers;
}

}  // namespace surfcast::pick
