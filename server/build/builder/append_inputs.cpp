#include "builder/append_inputs.h"

#include <oneapi/tbb/info.h>

namespace surfcast::builder {

bool is_leaf(const model::ModelFile& model, uint32_t block) {
  return model.tree().children(block).count == 0;
}

std::vector<uint32_t> leaves_of(const model::ModelFile& model) {
  std::vector<uint32_t> leaves;
  for (uint32_t block = 0; block < model.blocks().size(); ++block) {
    if (is_leaf(model, block)) leaves.push_back(block);
  }
  return leaves;
}

size_t append_threads() {
  return static_cast<size_t>(oneapi::tbb::info::default_concurrency());
}

}  // namespace surfcast::builder
