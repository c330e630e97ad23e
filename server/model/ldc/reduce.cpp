#include "ldc/reduce.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>
#include <tuple>
#include <utility>

#include "base/contract.h"
#include "surfel/even_sampling.h"

namespace surfcast::ldc {
namespace {

/// A level with at most this many surfels is kept whatever its ratio.
constexpr size_t kFew = 1024;
/// Factors on x, y and z that prefer z over y over x. They move the switch between images away from surfaces at 45
/// degrees, which are common.
constexpr glm::dvec3 kAxisBias{1, 1.1, 1.21};
/// A surfel belongs to the image of its surroundings while its normal is within 60 degrees of the axis. At that angle
/// the rays still sample its surface at half their density.
constexpr float kSmallestCosine = 0.5F;
/// Scatter within so many ray spacings of a disc's plane, on the ray of the disc, is the roughness of a surface.
constexpr double kOnSurface = 0.25;

/// The cell and its grid of rays.
struct Cube {
  glm::dvec3 min{0};
  double spacing = 1;  ///< of the rays, world units
  int lines = 1;       ///< rays along a side

  [[nodiscard]] int line(double offset) const {
    return std::clamp(static_cast<int>(std::floor(offset / spacing)), 0, lines - 1);
  }
  [[nodiscard]] double centre(int line) const { return (line + 0.5) * spacing; }
};

/// The intersection of a surfel's plane with its ray.
struct Crossing {
  uint32_t ray = 0;  ///< image, side of the surfel that faces the ray, and index within the image
  uint32_t surfel = 0;
  double depth = 0;  ///< of the intersection, along the ray

  bool operator<(const Crossing& other) const {
    return std::tie(ray, depth, surfel) < std::tie(other.ray, other.depth, other.surfel);
  }
};

glm::dvec3 squared(const glm::vec3& v) {
  return glm::dvec3(v) * glm::dvec3(v);
}

int largest_axis(const glm::dvec3& v) {
  if (v.x >= v.y && v.x >= v.z) return 0;
  return v.y >= v.z ? 1 : 2;
}

/// For every cell of two ray spacings' width, the sum of the squared components of its normals, weighted by area.
class Surroundings {
 public:
  Surroundings(std::span<const CoarseSurfel> surfels, const Cube& cube)
      : cube_(cube), side_(static_cast<size_t>(cube.lines + 1) / 2), squares_(side_ * side_ * side_, glm::dvec3(0)) {
    for (const CoarseSurfel& s : surfels) {
      if (!s.scatter) squares_[index(s)] += squared(s.normal) * (double{s.radius} * double{s.radius});
    }
  }

  /// The axis of the image that the surfel belongs to.
  [[nodiscard]] int axis(const CoarseSurfel& s) const {
    const int common = largest_axis(squares_[index(s)] * kAxisBias);
    if (std::abs(s.normal[common]) >= kSmallestCosine) return common;
    return largest_axis(squared(s.normal) * kAxisBias);
  }

 private:
  [[nodiscard]] size_t index(const CoarseSurfel& s) const {
    const glm::dvec3 offset = s.position - cube_.min;
    const auto at = [&](double x) { return static_cast<size_t>(cube_.line(x) / 2); };
    return (at(offset.z) * side_ + at(offset.y)) * side_ + at(offset.x);
  }

  const Cube& cube_;
  size_t side_;
  std::vector<glm::dvec3> squares_;
};

/// The ray of an image through a place within the cell, which faces the positive side of the axis or the other one.
uint32_t ray_through(const glm::dvec3& offset, int axis, bool away, const Cube& cube) {
  const int line_u = cube.line(offset[(axis + 1) % 3]);
  const int line_v = cube.line(offset[(axis + 2) % 3]);
  return static_cast<uint32_t>(((axis * 2 + static_cast<int>(away)) * cube.lines + line_v) * cube.lines + line_u);
}

std::array<uint32_t, 6> rays_through(const glm::dvec3& position, const Cube& cube) {
  const glm::dvec3 offset = position - cube.min;
  const auto ray = [&](int axis, bool away) { return ray_through(offset, axis, away, cube); };
  return {ray(0, false), ray(0, true), ray(1, false), ray(1, true), ray(2, false), ray(2, true)};
}

Crossing cross(const CoarseSurfel& s, uint32_t number, int axis, const Cube& cube, bool oriented) {
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  const glm::dvec3 offset = s.position - cube.min;
  const glm::dvec3 n(s.normal);
  const auto from_ray = [&](int side) { return offset[side] - cube.centre(cube.line(offset[side])); };
  return {ray_through(offset, axis, oriented && n[axis] < 0, cube), number,
          offset[axis] + (n[u] * from_ray(u) + n[v] * from_ray(v)) / n[axis]};
}

/// Finds the disc that scatter lies on.
class DiscFinder {
 public:
  DiscFinder(std::span<const CoarseSurfel> surfels, std::span<const Crossing> discs, const Cube& cube)
      : surfels_(surfels), discs_(discs), cube_(cube) {}

  /// The crossing of the disc on a ray through the same place whose plane is nearest, if it is near enough.
  [[nodiscard]] std::optional<Crossing> find(const CoarseSurfel& s) const {
    std::optional<Crossing> found;
    double nearest = kOnSurface * cube_.spacing;
    for (const uint32_t ray : rays_through(s.position, cube_)) {
      auto crossing = std::lower_bound(discs_.begin(), discs_.end(), ray,
                                       [](const Crossing& c, uint32_t wanted) { return c.ray < wanted; });
      for (; crossing != discs_.end() && crossing->ray == ray; ++crossing) {
        const CoarseSurfel& disc = surfels_[crossing->surfel];
        const double away = std::abs(glm::dot(glm::dvec3(disc.normal), s.position - disc.position));
        if (away >= nearest) continue;
        nearest = away;
        found = *crossing;
      }
    }
    return found;
  }

 private:
  std::span<const CoarseSurfel> surfels_;
  std::span<const Crossing> discs_;  ///< sorted
  const Cube& cube_;
};

/// The surfels of a cell by what they are averaged with.
struct Groups {
  std::vector<Crossing> surfaces;  ///< sorted: discs, and scatter that lies on them with the crossing of its disc
  std::vector<uint32_t> scatter;   ///< the rest
};

Groups group_surfels(std::span<const CoarseSurfel> surfels, const Cube& cube, bool oriented) {
  const Surroundings surroundings(surfels, cube);
  Groups groups;
  groups.surfaces.reserve(surfels.size());
  for (uint32_t i = 0; i < surfels.size(); ++i) {
    if (surfels[i].scatter) {
      groups.scatter.push_back(i);
    } else {
      groups.surfaces.push_back(cross(surfels[i], i, surroundings.axis(surfels[i]), cube, oriented));
    }
  }
  std::sort(groups.surfaces.begin(), groups.surfaces.end());
  if (groups.scatter.empty() || groups.surfaces.empty()) return groups;

  const DiscFinder discs(surfels, groups.surfaces, cube);
  std::vector<Crossing> on_discs;
  std::erase_if(groups.scatter, [&](uint32_t i) {
    const std::optional<Crossing> disc = discs.find(surfels[i]);
    if (disc) on_discs.push_back({disc->ray, i, disc->depth});
    return disc.has_value();
  });
  std::sort(on_discs.begin(), on_discs.end());
  const auto discs_end = static_cast<std::ptrdiff_t>(groups.surfaces.size());
  groups.surfaces.insert(groups.surfaces.end(), on_discs.begin(), on_discs.end());
  std::inplace_merge(groups.surfaces.begin(), groups.surfaces.begin() + discs_end, groups.surfaces.end());
  return groups;
}

/// Finds the class that covers the largest area; the lowest one of equal classes.
class ClassVotes {
 public:
  void add(double value, double area) {
    const auto found =
        std::find_if(areas_.begin(), areas_.end(), [&](const auto& vote) { return vote.first == value; });
    if (found != areas_.end()) {
      found->second += area;
    } else {
      areas_.emplace_back(value, area);
    }
  }
  [[nodiscard]] double winner() const {
    const auto better = [](const auto& a, const auto& b) {
      return a.second != b.second ? a.second < b.second : a.first > b.first;
    };
    return std::max_element(areas_.begin(), areas_.end(), better)->first;
  }

 private:
  std::vector<std::pair<double, double>> areas_;
};

/// The radius of an average: that of the total area of its surfels, at most that of a surfel on a complete grid. If the
/// surfels are farther apart than the rays, the mean of their radii, weighted by area.
float radius_of(double squares, double cubes, double cosine, const Cube& cube) {
  const double on_grid = surfel::kGridRadiusOverSpacing * cube.spacing / std::sqrt(std::max(cosine, 0.5));
  return static_cast<float>(std::max(std::min(std::sqrt(squares), on_grid), cubes / squares));
}

/// The radius of an average of scatter: that of the total area, at most half of the cube's side, where it fills its
/// cube, or the largest radius that it is made from. What is thin stays thin.
float scatter_radius_of(double squares, double largest, const Cube& cube) {
  return static_cast<float>(std::min(std::sqrt(squares), std::max(0.5 * cube.spacing, largest)));
}

/// The means of light and scalars, weighted by area; of light also by opacity.
class MeanLook {
 public:
  void add(const CoarseSurfel& s, double area) {
    light_ += area * double{s.opacity} * glm::dvec3(s.light);
    hidden_ += area * double{s.opacity};
    intensity_ += area * s.intensity;
    classes_.add(s.classification, area);
    area_ += area;
  }
  /// Light of nothing that hides stays as it is.
  void store(CoarseSurfel& s) const {
    if (hidden_ > 0) s.light = glm::vec3(light_ / hidden_);
    s.opacity = static_cast<float>(hidden_ / area_);
    s.intensity = intensity_ / area_;
    s.classification = classes_.winner();
  }

 private:
  glm::dvec3 light_{0};
  double hidden_ = 0;  ///< area that the surfels hide
  double intensity_ = 0;
  double area_ = 0;
  ClassVotes classes_;
};

/// Of scatter alone, or of a surface: scatter that lies on it adds to its look only.
CoarseSurfel average(std::span<const CoarseSurfel> surfels, std::span<const Crossing> crossings, const Cube& cube) {
  if (crossings.size() == 1) return surfels[crossings.front().surfel];
  const auto is_disc = [&](const Crossing& crossing) { return !surfels[crossing.surfel].scatter; };
  const auto disc = std::find_if(crossings.begin(), crossings.end(), is_disc);
  const CoarseSurfel& first = surfels[(disc == crossings.end() ? crossings.begin() : disc)->surfel];
  glm::dvec3 position(0);
  glm::dvec3 normal(0);
  double squares = 0;
  double cubes = 0;
  double largest = 0;
  MeanLook look;
  for (const Crossing& crossing : crossings) {
    const CoarseSurfel& s = surfels[crossing.surfel];
    const double area = double{s.radius} * double{s.radius};
    look.add(s, area);
    if (s.scatter != first.scatter) continue;
    const glm::dvec3 n(s.normal);
    position += area * (s.position - cube.min);
    normal += glm::dot(n, glm::dvec3(first.normal)) < 0 ? -area * n : area * n;
    squares += area;
    cubes += area * double{s.radius};
    largest = std::max(largest, double{s.radius});
  }
  const double length = glm::length(normal);
  CoarseSurfel result = first;
  result.position = cube.min + position / squares;
  if (length > 0) result.normal = glm::vec3(normal / length);
  const glm::vec3 n = glm::abs(result.normal);
  result.radius = first.scatter ? scatter_radius_of(squares, largest, cube)
                                : radius_of(squares, cubes, std::max({n.x, n.y, n.z}), cube);
  look.store(result);
  return result;
}

/// Scatter belongs to the cube, as wide as the rays are apart, that it lies in, whatever its normals: `ray` and `depth`
/// are those of the cube.
std::vector<Crossing> find_cubes(std::span<const CoarseSurfel> surfels, std::span<const uint32_t> scatter,
                                 const Cube& cube) {
  std::vector<Crossing> crossings;
  for (const uint32_t i : scatter) {
    const glm::dvec3 offset = surfels[i].position - cube.min;
    const auto ray = static_cast<uint32_t>(cube.line(offset.y) * cube.lines + cube.line(offset.x));
    crossings.push_back({ray, i, cube.centre(cube.line(offset.z))});
  }
  std::sort(crossings.begin(), crossings.end());
  return crossings;
}

/// Appends the averages of crossings on one ray whose depths differ by at most `reach`.
void append_averages(std::span<const CoarseSurfel> surfels, std::span<const Crossing> crossings, const Cube& cube,
                     double reach, std::vector<CoarseSurfel>& averages) {
  for (auto first = crossings.begin(); first != crossings.end();) {
    const auto last = std::find_if(first, crossings.end(), [&](const Crossing& c) {
      return c.ray != first->ray || c.depth - first->depth > reach;
    });
    averages.push_back(average(surfels, {first, last}, cube));
    first = last;
  }
}

/// The rays of twice the spacing.
Cube wider(const Cube& cube) {
  return {cube.min, 2 * cube.spacing, cube.lines / 2};
}

/// Appends the averages of scatter, in cubes of one ray spacing or two.
void append_scatter(std::span<const CoarseSurfel> surfels, std::span<const uint32_t> scatter, const Cube& cube,
                    std::vector<CoarseSurfel>& averages) {
  const size_t discs = averages.size();
  append_averages(surfels, find_cubes(surfels, scatter, cube), cube, 0, averages);
  const double part = static_cast<double>(averages.size() - discs);
  if (cube.lines == 1 || part <= kLargestPart * static_cast<double>(scatter.size())) return;
  averages.resize(discs);
  append_averages(surfels, find_cubes(surfels, scatter, wider(cube)), wider(cube), 0, averages);
}

std::vector<CoarseSurfel> resample(std::span<const CoarseSurfel> surfels, const Cube& cube, bool oriented) {
  const Groups groups = group_surfels(surfels, cube, oriented);
  std::vector<CoarseSurfel> averages;
  append_averages(surfels, groups.surfaces, cube, cube.spacing, averages);
  append_scatter(surfels, groups.scatter, cube, averages);
  return averages;
}

/// Rounds the positions to the lattice, clamps them to the cell, and sorts the surfels in Morton order.
void snap(std::vector<CoarseSurfel>& surfels, const surfel::Grid& grid, const OctreeKey& cell, int64_t steps) {
  const glm::i64vec3 lowest = glm::i64vec3(cell.x, cell.y, cell.z) * steps;
  std::vector<std::pair<uint64_t, CoarseSurfel>> sorted;
  sorted.reserve(surfels.size());
  for (CoarseSurfel s : surfels) {
    const glm::i64vec3 index = glm::clamp(grid.index(s.position), lowest, lowest + (steps - 1));
    s.position = grid.position(index);
    sorted.emplace_back(geometry::interleave(glm::u32vec3(index - lowest)), s);
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::transform(sorted.begin(), sorted.end(), surfels.begin(), [](const auto& entry) { return entry.second; });
}

bool few_enough(size_t coarse, size_t fine, double largest_part) {
  return coarse <= kFew ||
         (coarse <= kMaxCoarseSurfels && static_cast<double>(coarse) <= largest_part * static_cast<double>(fine));
}

}  // namespace

CoarseCell reduce(std::span<const CoarseSurfel> surfels, const geometry::RootCube& root, const OctreeKey& cell,
                  bool oriented, double largest_part) {
  SURFCAST_EXPECTS(!surfels.empty());
  const double side = std::ldexp(root.side, -cell.depth);
  const glm::dvec3 min = root.min + glm::dvec3(cell.x, cell.y, cell.z) * side;
  for (int lines = kLdcLines;; lines /= 2) {
    const Cube cube{min, side / lines, lines};
    std::vector<CoarseSurfel> averages = resample(surfels, cube, oriented);
    if (lines > 1 && !few_enough(averages.size(), surfels.size(), largest_part)) continue;
    const surfel::Grid grid{glm::dvec3(cube.spacing / kStepsPerRay), root.min};
    snap(averages, grid, cell, int64_t{lines} * kStepsPerRay);
    return {grid, static_cast<float>(surfel::kGridRadiusOverSpacing * cube.spacing), std::move(averages)};
  }
}

}  // namespace surfcast::ldc
