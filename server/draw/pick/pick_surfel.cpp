#include "pick/pick_surfel.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <string>

#include "model/hidden_members.h"
#include "pick/leaf_numbers.h"
#include "selection/block_hull.h"
#include "selection/frustum.h"

namespace surfcast::pick {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A leaf that the ray passes through, and the smallest camera z at which one of its items may be visible.
struct LeafOnRay {
  uint32_t block = 0;
  double nearest = 0;
};

/// An item that covers the pixel.
struct Candidate {
  kinds::PickRank rank;
  double depth = 0;    ///< camera z
  double opacity = 1;  ///< less than 1 for translucent items
};

/// Camera z at which the ray enters a box that is extended by `margin` on all sides; infinite if the ray misses it.
double entry_depth(const geometry::Box& box, double margin, const glm::dvec3& eye, const glm::dvec3& direction) {
  double first = 0;
  double last = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min[axis] - margin - eye[axis];
    const double high = box.max[axis] + margin - eye[axis];
    if (direction[axis] == 0) {
      if (low > 0 || high < 0) return kInfinity;
      continue;
    }
    const double a = low / direction[axis];
    const double b = high / direction[axis];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first <= last ? first : kInfinity;
}

Error too_wide(size_t most_blocks) {
  return {ErrorKind::kLimit, "pixel: more than " + std::to_string(most_blocks) +
                                 " blocks of the model may show in it; ask for a picture with more pixels"};
}

class Picker {
 public:
  Picker(const model::ModelFile& model, const kinds::PickQuery& query, SourceBlocks& source)
      : model_(model), query_(query), source_(source), frame_(query.frame) {
    const glm::dvec3 ray = frame_.ray(query.pixel);
    direction_ = frame_.right * ray.x + frame_.up * ray.y + frame_.forward;
  }

  Result<std::optional<kinds::PickedSurfel>> pick(const std::atomic<bool>& cancelled, size_t most_blocks) {
    size_t left = most_blocks;
    for (const LeafOnRay& leaf : leaves_on_ray()) {
      if (leaf.nearest > occluder_) break;
      if (left-- == 0) return fail(too_wide(most_blocks));
      if (cancelled.load(std::memory_order_relaxed)) return fail(ErrorKind::kCancelled, "cancelled");
      Result<std::shared_ptr<const kinds::SourceBlock>> block = source_.get(model_, leaf.block);
      if (!block) return fail(block);
      collect(leaf.block, std::move(*block));
    }
    return best();
  }

 private:
  /// The leaves that the ray passes through, sorted by `nearest`.
  [[nodiscard]] std::vector<LeafOnRay> leaves_on_ray() const {
    const SourceBlocks::Hulls hulls = hulls_of(model_, query_, source_);
    const selection::Frustum frustum(frame_, query_.pixel.x - kReachInPixels, query_.pixel.y - kReachInPixels,
                                     query_.pixel.x + kReachInPixels, query_.pixel.y + kReachInPixels);
    std::vector<LeafOnRay> leaves;
    std::vector<uint32_t> open = model::shown_roots(model_, query_.hidden_members);
    const auto sides = query_.transparent ? selection::Sides::kBoth : selection::Sides::kFront;
    while (!open.empty()) {
      const uint32_t block = open.back();
      open.pop_back();
      const selection::BlockHull& hull = (*hulls)[block];
      if (!selection::may_be_visible(hull, frustum, frame_.eye, sides) || !query_.may_show(hull.centres)) continue;
      const ldc::BlockTree::Children children = model_.tree().children(block);
      for (uint32_t i = 0; i < children.count; ++i) open.push_back(children.first + i);
      if (children.count > 0) continue;
      const double reach = kReachInRadii * hull.reach;
      const double farthest = glm::dot(frame_.forward, hull.centres.centre() - frame_.eye) + hull.centres.diagonal();
      const double pad = kReachInPixels * std::max(farthest, 0.0) / frame_.eta;
      const double entry = entry_depth(hull.centres, reach + pad, frame_.eye, direction_);
      if (entry < kInfinity) leaves.push_back({block, entry - reach});
    }
    std::sort(leaves.begin(), leaves.end(),
              [](const LeafOnRay& a, const LeafOnRay& b) { return a.nearest < b.nearest; });
    return leaves;
  }

  void collect(uint32_t number, std::shared_ptr<const kinds::SourceBlock> block) {
    std::vector<kinds::PickHit> hits;
    block->hit(query_, hits);
    for (const kinds::PickHit& hit : hits) {
      const Candidate candidate{{hit.form, number, hit.item}, hit.depth, hit.opacity};
      if (hit.opacity < 1) translucent_.push_back(candidate);
      if (hit.opacity < 1) continue;
      occluder_ = std::min(occluder_, hit.occluder);
      candidates_.push_back(candidate);
    }
    std::sort(translucent_.begin(), translucent_.end(), [](const Candidate& a, const Candidate& b) {
      return a.depth != b.depth ? a.depth < b.depth : a.rank < b.rank;
    });
    if (const Candidate* seen = seen_translucent()) occluder_ = std::min(occluder_, seen->depth);
    if (!hits.empty()) blocks_.emplace(number, std::move(block));
  }

  /// The item at which translucent ones have taken half of the light; null if they do not before an opaque one.
  [[nodiscard]] const Candidate* seen_translucent() const {
    double left = 1;
    for (const Candidate& candidate : translucent_) {
      left *= 1 - candidate.opacity;
      if (candidate.depth > occluder_) return nullptr;
      if (left <= kinds::kSeenThrough) return &candidate;
    }
    return nullptr;
  }

  [[nodiscard]] std::optional<kinds::PickedSurfel> best() const {
    const Candidate* best = seen_translucent();
    if (best != nullptr) return describe(*best);
    for (const Candidate& candidate : candidates_) {
      if (candidate.depth > occluder_) continue;
      if (best == nullptr || candidate.rank < best->rank) best = &candidate;
    }
    if (best == nullptr) return std::nullopt;
    return describe(*best);
  }

  [[nodiscard]] kinds::PickedSurfel describe(const Candidate& candidate) const {
    kinds::PickQuery query = query_;
    query.depth = candidate.depth;
    kinds::PickedSurfel picked = blocks_.at(candidate.rank.block)->describe(query, candidate.rank.item);
    picked.depth = candidate.depth;
    picked.number = leaf_numbers(model_)[candidate.rank.block] + candidate.rank.item;
    if (!model_.members().empty()) picked.member = model_.part(candidate.rank.block).member;
    return picked;
  }

  const model::ModelFile& model_;
  const kinds::PickQuery& query_;
  SourceBlocks& source_;
  const geometry::CameraFrame& frame_;
  glm::dvec3 direction_{0};  ///< world direction of the pixel's ray; its component along the view axis is 1
  std::map<uint32_t, std::shared_ptr<const kinds::SourceBlock>> blocks_;  ///< blocks that contain candidates
  std::vector<Candidate> translucent_;                                    ///< in ascending depth
  std::vector<Candidate> candidates_;
  double occluder_ = kInfinity;  ///< camera z behind which everything is hidden
};

}  // namespace

Result<std::optional<kinds::PickedSurfel>> pick_surfel(const model::ModelFile& model, const kinds::PickQuery& query,
                                                       SourceBlocks& blocks, const std::atomic<bool>& cancelled,
                                                       size_t most_blocks) {
  return Picker(model, query, blocks).pick(cancelled, most_blocks);
}

}  // namespace surfcast::pick
