#include "pick/pick_surfel.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "pick/opaque_disc.h"
#include "selection/block_hull.h"
#include "selection/frustum.h"
#include "surfel/drawn_radius.h"

namespace surfcast::pick {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Discs reach no farther than this many radii from their centres.
constexpr double kReachInRadii = 2;
/// The prefilter of visibility widens discs by less, pixels.
constexpr double kReachInPixels = 2;

/// A leaf that the ray passes, and the least camera z at which something of it can be seen.
struct LeafOnRay {
  uint32_t block = 0;
  double nearest = 0;
};

/// A surfel that covers the pixel.
struct Candidate {
  DiscHit hit;
  size_t block = 0;  ///< number among the decoded ones
  size_t surfel = 0;
};

/// Camera z at which the ray enters a box, centred about the eye, grown by `margin`; infinite if it misses.
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

class Picker {
 public:
  Picker(const model::ModelFile& model, const PickQuery& query, SourceBlocks& source)
      : model_(model), query_(query), source_(source), frame_(query.frame) {
    ray_ = frame_.ray(query.pixel);
    direction_ = frame_.right * ray_.x + frame_.up * ray_.y + frame_.forward;
  }

  Result<std::optional<PickedSurfel>> pick(const std::atomic<bool>& cancelled) {
    for (const LeafOnRay& leaf : leaves_on_ray()) {
      if (leaf.nearest > occluder_) break;
      if (cancelled.load(std::memory_order_relaxed)) return fail(ErrorKind::kCancelled, "cancelled");
      Result<std::shared_ptr<const model::DecodedBlock>> block = source_.get(model_, leaf.block);
      if (!block) return fail(std::move(block.error()));
      collect(**block);
      if (!candidates_.empty() && candidates_.back().block == blocks_.size()) blocks_.push_back(std::move(*block));
    }
    return best();
  }

 private:
  /// By the depth from which they may be seen.
  [[nodiscard]] std::vector<LeafOnRay> leaves_on_ray() const {
    const std::vector<selection::BlockHull> hulls = selection::block_hulls(model_.tree());
    const selection::Frustum frustum(frame_, query_.pixel.x - kReachInPixels, query_.pixel.y - kReachInPixels,
                                     query_.pixel.x + kReachInPixels, query_.pixel.y + kReachInPixels);
    std::vector<LeafOnRay> leaves;
    std::vector<uint32_t> open(model_.tree().roots().begin(), model_.tree().roots().end());
    while (!open.empty()) {
      const uint32_t block = open.back();
      open.pop_back();
      const selection::BlockHull& hull = hulls[block];
      if (!selection::may_be_visible(hull, frustum, frame_.eye) || !query_.clip.may_show(hull.centres)) continue;
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

  [[nodiscard]] bool hidden(const model::DecodedBlock& block, size_t surfel) const {
    if (!query_.clip.shows(block.position(surfel))) return true;
    if (query_.hidden_classes.none()) return false;
    for (const surfel::ScalarAttribute& scalar : block.scalars) {
      if (scalar.name != "classification") continue;
      const double code = value_at(scalar.values, surfel);
      return query_
          .hidden_classes[static_cast<size_t>(std::isnan(code) ? 0 : std::clamp(std::round(code), 0.0, 255.0))];
    }
    return false;
  }

  void collect(const model::DecodedBlock& block) {
    const float widest = surfel::largest_drawn_radius(block.radii);
    for (size_t i = 0; i < block.size(); ++i) {
      const glm::dvec3 o = frame_.to_camera(block.position(i));
      const glm::dvec3 n = frame_.rotate(glm::dvec3(block.normals[i]));
      if (model_.info().oriented && glm::dot(n, o) >= 0) continue;
      const auto hit = hit_disc(o, n, double{std::min(block.radii[i], widest)}, ray_, frame_.eta);
      if (!hit || hidden(block, i)) continue;
      occluder_ = std::min(occluder_, hit->occluder);
      candidates_.push_back({*hit, blocks_.size(), i});
    }
  }

  [[nodiscard]] std::optional<PickedSurfel> best() const {
    const Candidate* best = nullptr;
    for (const Candidate& candidate : candidates_) {
      if (candidate.hit.depth > occluder_) continue;
      if (best == nullptr || candidate.hit.form < best->hit.form) best = &candidate;
    }
    if (best == nullptr) return std::nullopt;
    return describe(*blocks_[best->block], best->surfel);
  }

  [[nodiscard]] PickedSurfel describe(const model::DecodedBlock& block, size_t i) const {
    PickedSurfel picked;
    picked.position = block.position(i);
    picked.normal = glm::normalize(glm::dvec3(block.normals[i]));
    const glm::dvec3 from_eye = picked.position - frame_.eye;
    if (!model_.info().oriented && glm::dot(picked.normal, from_eye) > 0) picked.normal = -picked.normal;
    if (!block.colors.empty()) picked.color = color_of(block.colors[i]);
    picked.radius = double{block.radii[i]};
    picked.distance = glm::length(from_eye);
    for (const surfel::ScalarAttribute& scalar : block.scalars) {
      picked.values.push_back({scalar.name, value_at(scalar.values, i)});
    }
    return picked;
  }

  [[nodiscard]] glm::u8vec3 color_of(const glm::u16vec3& color) const {
    if (model_.info().color_bits == 8) return {color.r, color.g, color.b};
    const auto level = [](uint32_t value) { return static_cast<uint8_t>((value * 255 + 32767) / 65535); };
    return {level(color.r), level(color.g), level(color.b)};
  }

  static double value_at(const surfel::ScalarValues& values, size_t i) {
    return std::visit([i](const auto& column) { return static_cast<double>(column[i]); }, values);
  }

  const model::ModelFile& model_;
  const PickQuery& query_;
  SourceBlocks& source_;
  const geometry::CameraFrame& frame_;
  glm::dvec3 ray_{0};                                               ///< camera frame, z = 1
  glm::dvec3 direction_{0};                                         ///< the same in the world
  std::vector<std::shared_ptr<const model::DecodedBlock>> blocks_;  ///< those with candidates
  std::vector<Candidate> candidates_;
  double occluder_ = kInfinity;  ///< camera z behind which everything is hidden
};

}  // namespace

Result<std::optional<PickedSurfel>> pick_surfel(const model::ModelFile& model, const PickQuery& query,
                                                SourceBlocks& blocks, const std::atomic<bool>& cancelled) {
  return Picker(model, query, blocks).pick(cancelled);
}

}  // namespace surfcast::pick
