#include "scan/surface_spacing.h"

#include <algorithm>
#include <array>
#include <limits>
#include <nanoflann.hpp>
#include <tuple>
#include <utility>

#include "base/hash.h"

namespace surfcast::scan {
namespace {

constexpr size_t kNearest = 8;
constexpr uint64_t kPointsPerSample = 8;
/// Samples of a whole cloud, at most: 28 bytes each, and a tree over them.
constexpr uint64_t kMostSamples = uint64_t{1} << 20;

constexpr size_t kAsked = 6;
constexpr int kMutual = 2;

/// Adapter for nanoflann.
struct Positions {
  std::vector<glm::dvec3> local;

  // nanoflann requires these names.
  [[nodiscard]] size_t kdtree_get_point_count() const { return local.size(); }
  [[nodiscard]] double kdtree_get_pt(uint32_t sample, size_t axis) const {
    return local[sample][static_cast<int>(axis)];
  }
  template <typename Bounds>
  bool kdtree_get_bbox(Bounds&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Positions, double, uint32_t>,
                                                 Positions, 3, uint32_t>;

bool before(const SurfaceSample& a, const SurfaceSample& b) {
  const auto key = [](const SurfaceSample& s) {
    return std::tuple(s.position.x, s.position.y, s.position.z, s.radius);
  };
  return key(a) < key(b);
}

}  // namespace

uint64_t points_per_sample(uint64_t points) {
  return std::max(kPointsPerSample, points / kMostSamples);
}

bool is_sampled(const Sites& sites, const NeighbourGraph& graph, uint32_t site, uint64_t per_sample) {
  if (hash_of(std::as_bytes(std::span(&sites.positions[site], 1))) % per_sample != 0) return false;
  int mutual = 0;
  for (const uint32_t j : graph.of(site).first(std::min(kAsked, graph.degree))) {
    const std::span<const uint32_t> theirs = graph.of(j);
    mutual += std::find(theirs.begin(), theirs.end(), site) != theirs.end() ? 1 : 0;
  }
  return mutual >= kMutual;
}

struct SurfaceSpacing::Index {
  LocalFrame frame;
  std::vector<float> radii;
  Positions positions;
  Tree tree;

  Index(const geometry::Box& bounds, std::vector<float> sample_radii, Positions local)
      : frame(bounds),
        radii(std::move(sample_radii)),
        positions(std::move(local)),
        tree(3, positions, nanoflann::KDTreeSingleIndexAdaptorParams(12)) {}
};

SurfaceSpacing::SurfaceSpacing(std::vector<SurfaceSample> samples, const geometry::Box& bounds) {
  std::sort(samples.begin(), samples.end(), before);
  std::vector<float> radii;
  Positions positions;
  for (const SurfaceSample& sample : samples) {
    radii.push_back(sample.radius);
    positions.local.push_back(sample.position);
  }
  index_ = std::make_unique<Index>(bounds, std::move(radii), std::move(positions));
}

SurfaceSpacing::SurfaceSpacing(SurfaceSpacing&&) noexcept = default;
SurfaceSpacing& SurfaceSpacing::operator=(SurfaceSpacing&&) noexcept = default;
SurfaceSpacing::~SurfaceSpacing() = default;

double SurfaceSpacing::at(const glm::dvec3& position) const {
  if (index_->radii.empty()) return std::numeric_limits<double>::infinity();
  const glm::dvec3 local = index_->frame.to_local(position);
  std::array<uint32_t, kNearest> ids{};
  std::array<double, kNearest> squared_distances{};
  const size_t found = index_->tree.knnSearch(&local.x, kNearest, ids.data(), squared_distances.data());
  std::array<float, kNearest> radii{};
  const auto end = std::transform(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(found), radii.begin(),
                                  [this](uint32_t id) { return index_->radii[id]; });
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(found / 2);
  std::nth_element(radii.begin(), middle, end);
  return double{*middle};
}

}  // namespace surfcast::scan
