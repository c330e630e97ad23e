#include "model/hidden_members.h"

#include <algorithm>

namespace surfcast::model {

std::vector<bool> hidden_members(const ModelFile& model, std::span<const std::string> names) {
  std::vector<bool> hidden;
  for (const Member& member : model.members()) hidden.push_back(std::ranges::find(names, member.name) != names.end());
  if (std::ranges::find(hidden, true) == hidden.end()) return {};
  return hidden;
}

std::vector<uint32_t> shown_roots(const ModelFile& model, const std::vector<bool>& hidden_members) {
  std::vector<uint32_t> roots(model.tree().roots().begin(), model.tree().roots().end());
  if (hidden_members.empty()) return roots;
  std::erase_if(roots, [&](uint32_t root) { return hidden_members[model.part(root).member]; });
  return roots;
}

}  // namespace surfcast::model
