#include "model/hidden_members.h"

#include <algorithm>
#include <bitset>

namespace surfcast::model {

std::vector<bool> hidden_members(const ModelFile& model, std::span<const std::string> names) {
  std::vector<bool> hidden;
  for (const Member& member : model.members()) hidden.push_back(std::ranges::find(names, member.name) != names.end());
  if (std::ranges::find(hidden, true) == hidden.end()) return {};
  return hidden;
}

std::vector<uint32_t> shown_roots(const ModelFile& model, const std::vector<bool>& hidden_members) {
  const std::span<const uint32_t> roots = model.tree().roots();
  if (hidden_members.empty()) return {roots.begin(), roots.end()};
  std::bitset<kMaxMembers> hidden;
  for (size_t i = 0; i < hidden_members.size(); ++i) hidden[i] = hidden_members[i];
  std::vector<uint32_t> shown;
  std::vector<uint32_t> open(roots.rbegin(), roots.rend());
  while (!open.empty()) {
    const uint32_t block = open.back();
    open.pop_back();
    const std::bitset<kMaxMembers> members = model.members_of(block);
    if ((members & hidden).none()) {
      shown.push_back(block);
    } else if (members != (members & hidden)) {
      const auto [first, count] = model.tree().children(block);
      for (uint32_t child = first + count; child-- > first;) open.push_back(child);
    }
  }
  std::ranges::sort(shown);
  return shown;
}

}  // namespace surfcast::model
