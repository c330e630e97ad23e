#include "exporter/node_sample.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace surfcast::exporter {
namespace {

class NodeSampler {
 public:
  NodeSampler(std::span<const SamplePoint> points, std::span<const ChildPoints> children)
      : points_(points), children_(children), chosen_(even_sample(points)) {}

  std::vector<uint32_t> take(size_t least) {
    for (const ChildPoints& child : children_) {
      if (is_emptied(child, 0)) chosen_.erase(last_to_choose(child));
    }
    if (chosen_.size() < least) top_up(least);
    return std::move(chosen_);
  }

 private:
  using Place = std::vector<uint32_t>::iterator;

  Place from(const ChildPoints& child) { return std::ranges::lower_bound(chosen_, child.first); }
  Place to(const ChildPoints& child) { return std::ranges::lower_bound(chosen_, child.first + child.count); }
  Place last_to_choose(const ChildPoints& child) {
    return std::ranges::max_element(from(child), to(child), {}, [this](uint32_t i) { return points_[i].hash; });
  }

  /// Whether a child that has nodes below it keeps no point if `more` of its points are taken.
  bool is_emptied(const ChildPoints& child, size_t more) {
    return child.has_nodes && static_cast<size_t>(to(child) - from(child)) + more == child.count;
  }

  void top_up(size_t least) {
    std::vector<uint32_t> order(points_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, {}, [this](uint32_t i) { return points_[i].hash; });
    for (size_t i = 0; i < order.size() && chosen_.size() < least; ++i) {
      const auto child = std::ranges::upper_bound(children_, order[i], {}, &ChildPoints::first) - 1;
      const auto place = std::ranges::lower_bound(chosen_, order[i]);
      const bool taken = place != chosen_.end() && *place == order[i];
      if (!taken && !is_emptied(*child, 1)) chosen_.insert(place, order[i]);
    }
  }

  std::span<const SamplePoint> points_;
  std::span<const ChildPoints> children_;
  std::vector<uint32_t> chosen_;
};

}  // namespace

std::vector<uint32_t> node_sample(std::span<const SamplePoint> points, std::span<const ChildPoints> children,
                                  int depth) {
  return NodeSampler(points, children).take(static_cast<size_t>(depth) + 1);
}

}  // namespace surfcast::exporter
