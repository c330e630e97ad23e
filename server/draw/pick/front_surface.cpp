#include "pick/front_surface.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>

#include "model/hidden_members.h"
#include "pick/leaf_numbers.h"
#include "selection/block_hull.h"
#include "selection/frustum.h"

namespace surfcast::pick {
namespace {

/// Pixels a side of the rectangles that are searched at once.
constexpr int kRegionSide = 1024;

/// A leaf in view of a region.
struct LeafInView {
  uint32_t block = 0;
  double nearest = 0;        ///< lower bound of the camera z of its items
  kinds::PixelRange pixels;  ///< that its items may cover
};

/// The pixels of a region that a box, grown by `reach` world units, may cover: those of its corners, or the whole
/// region if it reaches the eye plane.
kinds::PixelRange pixels_of(const geometry::Box& box, double reach, const geometry::CameraFrame& frame,
                            const kinds::PixelRange& region) {
  glm::dvec2 low(std::numeric_limits<double>::infinity());
  glm::dvec2 high = -low;
  for (int corner = 0; corner < 8; ++corner) {
    const auto of = [&](int axis) { return (corner >> axis & 1) == 0 ? box.min[axis] - reach : box.max[axis] + reach; };
    const glm::dvec3 at = frame.to_camera({of(0), of(1), of(2)});
    if (at.z <= reach) return region;
    const glm::dvec2 pixel = frame.project(at);
    low = glm::min(low, pixel);
    high = glm::max(high, pixel);
  }
  const glm::dvec2 first(region.first);
  const glm::dvec2 last(region.last);
  return {glm::ivec2(glm::clamp(glm::floor(low - kReachInPixels), first, last)),
          glm::ivec2(glm::clamp(glm::ceil(high + kReachInPixels), first, last))};
}

/// A lower bound of the camera z of a block's items.
double nearest_of(const selection::BlockHull& hull, const geometry::CameraFrame& frame) {
  const glm::dvec3 half = 0.5 * hull.centres.size();
  const double depth = glm::dot(half, glm::abs(frame.forward));
  // Discs extend by less than two radii (kinds::nearest_depth).
  return glm::dot(frame.forward, hull.centres.centre() - frame.eye) - depth - 2 * hull.reach;
}

class FrontSearch {
 public:
  FrontSearch(const model::ModelFile& model, const kinds::PickQuery& query, SourceBlocks& source)
      : model_(model),
        query_(query),
        source_(source),
        hulls_(hulls_of(model, query, source)),
        numbers_(leaf_numbers(model)) {}

  Status search(const kinds::PixelRange& region, const std::atomic<bool>& cancelled,
                std::vector<FrontPixel>& pixels) const {
    pixels.assign(static_cast<size_t>(region.size().x) * static_cast<size_t>(region.size().y), {});
    kinds::PixelHits hits(region);
    for (const LeafInView& leaf : leaves_in(region)) {
      if (cancelled.load(std::memory_order_relaxed)) return fail(ErrorKind::kCancelled, "cancelled");
      if (!hits.may_show(leaf.pixels, leaf.nearest)) continue;
      const Result<std::shared_ptr<const kinds::SourceBlock>> block = source_.get(model_, leaf.block);
      if (!block) return fail(block);
      hits.begin_block(leaf.block);
      (*block)->cover(query_, hits);
    }
    read(hits, pixels);
    return {};
  }

 private:
  /// Sorted by `nearest`.
  [[nodiscard]] std::vector<LeafInView> leaves_in(const kinds::PixelRange& region) const {
    const geometry::CameraFrame& frame = query_.frame;
    const selection::Frustum frustum(frame, region.first.x - kReachInPixels, region.first.y - kReachInPixels,
                                     region.last.x + 1 + kReachInPixels, region.last.y + 1 + kReachInPixels);
    std::vector<LeafInView> leaves;
    std::vector<uint32_t> open = model::shown_roots(model_, query_.hidden_members);
    const auto sides = query_.transparent ? selection::Sides::kBoth : selection::Sides::kFront;
    while (!open.empty()) {
      const uint32_t block = open.back();
      open.pop_back();
      const selection::BlockHull& hull = (*hulls_)[block];
      if (!selection::may_be_visible(hull, frustum, frame.eye, sides) || !query_.may_show(hull.centres)) continue;
      const ldc::BlockTree::Children children = model_.tree().children(block);
      for (uint32_t i = 0; i < children.count; ++i) open.push_back(children.first + i);
      if (children.count > 0) continue;
      leaves.push_back({block, nearest_of(hull, frame), pixels_of(hull.centres, 2 * hull.reach, frame, region)});
    }
    std::sort(leaves.begin(), leaves.end(), [](const LeafInView& a, const LeafInView& b) {
      return std::pair(a.nearest, a.block) < std::pair(b.nearest, b.block);
    });
    return leaves;
  }

  /// Copies what the pixels of a region show.
  void read(const kinds::PixelHits& hits, std::vector<FrontPixel>& pixels) const {
    const kinds::PixelRange& region = hits.range();
    auto pixel = pixels.begin();
    for (int y = region.first.y; y <= region.last.y; ++y) {
      for (int x = region.first.x; x <= region.last.x; ++x, ++pixel) {
        const std::optional<kinds::ShownItem> item = hits.shown({x, y});
        if (!item) continue;
        *pixel = {item->depth, numbers_[item->rank.block] + item->rank.item, item->look.normal, item->look.code};
      }
    }
  }

  const model::ModelFile& model_;
  const kinds::PickQuery& query_;
  SourceBlocks& source_;
  SourceBlocks::Hulls hulls_;
  std::vector<uint64_t> numbers_;
};

}  // namespace

std::vector<SurfaceRegion> surface_regions(int width, int height) {
  std::vector<SurfaceRegion> regions;
  for (int y = 0; y < height; y += kRegionSide) {
    for (int x = 0; x < width; x += kRegionSide) {
      const glm::ivec2 end = glm::min(glm::ivec2(x, y) + kRegionSide, glm::ivec2(width, height));
      regions.push_back({{x, y}, end - 1});
    }
  }
  return regions;
}

Status search_front_surface(const model::ModelFile& model, const kinds::PickQuery& query, SourceBlocks& blocks,
                            const std::atomic<bool>& cancelled, const RegionDone& done) {
  const FrontSearch search(model, query, blocks);
  std::vector<FrontPixel> pixels;
  for (const SurfaceRegion& region : surface_regions(query.frame.width, query.frame.height)) {
    if (Status status = search.search(region, cancelled, pixels); !status) return status;
    if (Status status = done(region, pixels); !status) return status;
  }
  return {};
}

Result<std::vector<FrontPixel>> find_front_surface(const model::ModelFile& model, const kinds::PickQuery& query,
                                                   SourceBlocks& blocks, const std::atomic<bool>& cancelled) {
  const int width = query.frame.width;
  std::vector<FrontPixel> picture(static_cast<size_t>(width) * static_cast<size_t>(query.frame.height));
  const auto place = [&](const SurfaceRegion& region, std::span<const FrontPixel> pixels) -> Status {
    place_region(region, pixels, width, picture);
    return {};
  };
  if (Status status = search_front_surface(model, query, blocks, cancelled, place); !status) {
    return fail(status);
  }
  return picture;
}

void place_region(const SurfaceRegion& region, std::span<const FrontPixel> pixels, int width,
                  std::vector<FrontPixel>& picture) {
  const auto row = static_cast<size_t>(region.size().x);
  for (int y = region.first.y; y <= region.last.y; ++y, pixels = pixels.subspan(row)) {
    const size_t start = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(region.first.x);
    std::ranges::copy(pixels.first(row), picture.begin() + static_cast<std::ptrdiff_t>(start));
  }
}

}  // namespace surfcast::pick
