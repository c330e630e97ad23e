#include "exporter/node_pages.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/contract.h"
#include "geometry/morton.h"

namespace surfcast::exporter {
namespace {

/// Subtrees of at most as many nodes are not worth a request of their own.
constexpr size_t kSmallSubtree = 8;

/// The Morton code of the lowest corner.
uint64_t first_code(const ldc::OctreeKey& key) {
  const int below = geometry::kMortonDepth - key.depth;
  return geometry::interleave({key.x << below, key.y << below, key.z << below});
}

class PageMaker {
 public:
  PageMaker(std::span<const ldc::OctreeKey> nodes, size_t most)
      : nodes_(nodes), most_(most), order_(nodes.size()), sizes_(nodes.size(), 1) {
    std::iota(order_.begin(), order_.end(), size_t{0});
    std::ranges::sort(order_, {}, [&](size_t i) { return std::pair(first_code(nodes[i]), nodes[i].depth); });
    for (size_t at = order_.size(); at-- > 0;) {
      for (const size_t child : children_of(at)) sizes_[at] += sizes_[child];
    }
  }

  std::vector<NodePage> make() {
    pages_.resize(1);
    place(0, 0);
    return std::move(pages_);
  }

 private:
  /// A node is followed by all nodes below it, a child with what is below it after another.
  [[nodiscard]] std::vector<size_t> children_of(size_t at) const {
    std::vector<size_t> children;
    for (size_t next = at + 1; next < order_.size() && ldc::contains(nodes_[order_[at]], nodes_[order_[next]]);
         next += sizes_[next]) {
      children.push_back(next);
    }
    return children;
  }

  void place(size_t at, size_t page) {
    if (sizes_[at] <= most_) return place_all(at, page);
    pages_[page].nodes.push_back(order_[at]);
    for (const size_t child : children_of(at)) {
      const bool own_page = sizes_[child] <= most_ && sizes_[child] > kSmallSubtree;
      own_page ? place_apart(child, page) : place(child, page);
    }
  }

  void place_apart(size_t at, size_t page) {
    pages_[page].subpages.push_back(pages_.size());
    pages_.emplace_back();
    place_all(at, pages_.size() - 1);
  }

  void place_all(size_t at, size_t page) {
    for (size_t i = at; i < at + sizes_[at]; ++i) pages_[page].nodes.push_back(order_[i]);
  }

  std::span<const ldc::OctreeKey> nodes_;
  size_t most_;
  std::vector<size_t> order_;  ///< numbers of nodes, every one before those below it
  std::vector<size_t> sizes_;  ///< of the subtrees of nodes, in this order
  std::vector<NodePage> pages_;
};

}  // namespace

std::vector<NodePage> make_pages(std::span<const ldc::OctreeKey> nodes, size_t most) {
  SURFCAST_EXPECTS(!nodes.empty());
  return PageMaker(nodes, most).make();
}

}  // namespace surfcast::exporter
