#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace surfcast::estimation {

/// Disjoint sets (union-find) whose members have signs relative to each other. Joining two members states whether they
/// agree or oppose. It determines the sign of every member of one set relative to every member of the other.
class SignedForest {
 public:
  explicit SignedForest(size_t members) : parents_(members), opposed_(members, 0) {
    std::iota(parents_.begin(), parents_.end(), 0U);
  }

  /// The representative of the member's set, and whether the member opposes it.
  std::pair<uint32_t, bool> find(uint32_t member) {
    uint32_t root = member;
    uint8_t sign = 0;
    while (parents_[root] != root) {
      sign ^= opposed_[root];
      root = parents_[root];
    }
    compress(member, root, sign);
    return {root, sign != 0};
  }

  /// Joins the sets of two members that agree or oppose. No effect if they are in the same set.
  void join(uint32_t a, uint32_t b, bool oppose) {
    const auto [root_a, sign_a] = find(a);
    const auto [root_b, sign_b] = find(b);
    if (root_a == root_b) return;
    parents_[root_b] = root_a;
    opposed_[root_b] = (sign_a != sign_b) != oppose ? 1 : 0;
  }

 private:
  /// Path compression: attaches every member on the path directly to the root. `sign` is that of the first member
  /// relative to the root.
  void compress(uint32_t member, uint32_t root, uint8_t sign) {
    while (member != root) {
      const uint32_t parent = std::exchange(parents_[member], root);
      sign ^= std::exchange(opposed_[member], sign);
      member = parent;
    }
  }

  std::vector<uint32_t> parents_;
  std::vector<uint8_t> opposed_;  ///< relative to the parent
};

}  // namespace surfcast::estimation
