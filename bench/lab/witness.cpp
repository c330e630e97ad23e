#include "lab/witness.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include <tbb/parallel_for.h>

#include "base/contract.h"
#include "kinds/opaque_disc.h"
#include "lab/nearest_points.h"
#include "lab/paint_rows.h"

namespace surfcast::lab {
namespace {

constexpr size_t kWide = 32;    ///< neighbours of the larger scale
constexpr size_t kNear = 12;    ///< neighbours of the smaller scale
constexpr size_t kNearest = 6;  ///< neighbours whose mean distance is the spacing

// The strict test of a surface.
constexpr double kThickness = 0.3;  ///< largest deviation from the plane of the 12, in spacings
constexpr double kFlatness = 0.1;   ///< largest l0 / l1 of the 32
constexpr size_t kPeers = 8;
constexpr size_t kAgreeing = 6;  ///< of the peers
const double kAgreement = std::cos(37 * std::numbers::pi / 180);

// The sizes of discs and splats.
constexpr double kDiscFactor = 1.2;
constexpr double kDiscLimit = 2;       ///< spacings of the surfaces around
constexpr double kSplatFactor = 0.25;  ///< of the distance to the nearest point
constexpr size_t kSampling = 8;        ///< the spacing of the surfaces around is a median over every eighth point
constexpr size_t kSamples = 8;         ///< of a surface, and of these eight

// The radius of a disc, as in docs/kernel.md, Radii.
constexpr double kLargestRatio = 3;
constexpr double kReachShare = 0.6;
constexpr double kBorderShare = 0.5;
constexpr double kOpenAngle = 2.4;         // radians
constexpr double kSecondOpenAngle = 1.75;  // radians
constexpr double kSameSide = 0.7;          // cosine
constexpr size_t kAgreeingBorders = 2;

/// Spread of a point and its neighbours, ascending, in squared world units, and the direction of least spread.
struct Spread {
  Eigen::Vector3d values;
  Eigen::Vector3d least;
};

Spread spread_of(std::span<const glm::dvec3> points, size_t point, std::span<const uint32_t> neighbours) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (const uint32_t j : neighbours) {
    const glm::dvec3 d = points[j] - points[point];
    const Eigen::Vector3d v(d.x, d.y, d.z);
    mean += v;
    products += v * v.transpose();
  }
  const auto count = static_cast<double>(neighbours.size() + 1);
  const Eigen::Matrix3d covariance = products / count - mean * mean.transpose() / (count * count);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  return {solver.eigenvalues().cwiseMax(0.0), solver.eigenvectors().col(0)};
}

/// The points with their neighbours, without themselves.
class Neighbours {
 public:
  explicit Neighbours(std::span<const glm::dvec3> points)
      : points_(points), found_(nearest_points(points, points, kWide + 1)) {}

  [[nodiscard]] std::span<const uint32_t> of(size_t i, size_t count) const {
    return found_.of(i).subspan(1, std::min(count, found_.degree - 1));
  }
  [[nodiscard]] double distance(size_t i, size_t k) const { return std::sqrt(found_.squared_distances_of(i)[k + 1]); }
  [[nodiscard]] std::span<const glm::dvec3> points() const { return points_; }

 private:
  std::span<const glm::dvec3> points_;
  NearestPoints found_;
};

struct Shape {
  glm::dvec3 normal{0};
  bool flat = false;  ///< thin at the smaller scale and flat at the larger one
};

Shape shape_of(const Neighbours& neighbours, size_t i, double spacing) {
  const Spread near = spread_of(neighbours.points(), i, neighbours.of(i, kNear));
  const Spread wide = spread_of(neighbours.points(), i, neighbours.of(i, kWide));
  const bool flat = std::sqrt(near.values[0]) < kThickness * spacing && wide.values[0] < kFlatness * wide.values[1];
  return {{near.least.x(), near.least.y(), near.least.z()}, flat};
}

bool agrees_with_peers(const Neighbours& neighbours, const std::vector<Shape>& shapes, size_t i) {
  const std::span<const uint32_t> peers = neighbours.of(i, kPeers);
  const auto agreeing = std::ranges::count_if(
      peers, [&](uint32_t j) { return std::abs(glm::dot(shapes[i].normal, shapes[j].normal)) > kAgreement; });
  return agreeing >= static_cast<std::ptrdiff_t>(kAgreeing);
}

/// A neighbour in the tangent plane.
struct Bearing {
  double angle = 0;  ///< radians
  double distance = 0;
};

/// The neighbours of a point around its normal, sorted by angle.
struct Around {
  glm::dvec3 e0;
  glm::dvec3 e1;
  std::vector<Bearing> bearings;
};

Around around(const Neighbours& neighbours, size_t i, const glm::dvec3& n) {
  const glm::dvec3 axis = std::abs(n.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  Around result{glm::normalize(glm::cross(n, axis)), {}, {}};
  result.e1 = glm::cross(n, result.e0);
  for (const uint32_t j : neighbours.of(i, kNear)) {
    const glm::dvec3 d = neighbours.points()[j] - neighbours.points()[i];
    result.bearings.push_back({std::atan2(glm::dot(d, result.e1), glm::dot(d, result.e0)), glm::length(d)});
  }
  std::ranges::sort(result.bearings, {}, &Bearing::angle);
  return result;
}

/// The distance to the nearest neighbour in that of eight directions in which it is farthest.
double reach_of(const std::vector<Bearing>& bearings) {
  double reach = 0;
  for (int k = 0; k < 8; ++k) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Bearing& b : bearings) {
      const double off = std::abs(std::remainder(b.angle - std::numbers::pi * k / 4, 2 * std::numbers::pi));
      if (off < std::numbers::pi / 4) nearest = std::min(nearest, b.distance / std::cos(off));
    }
    if (std::isfinite(nearest)) reach = std::max(reach, nearest);
  }
  return reach;
}

/// The direction of the one wide angle without neighbours; zero if there is none, or a second one.
glm::dvec3 opening_of(const Around& around) {
  double widest = 0;
  double second = 0;
  double middle = 0;
  for (size_t i = 0; i < around.bearings.size(); ++i) {
    const bool last = i + 1 == around.bearings.size();
    const double next = last ? around.bearings[0].angle + 2 * std::numbers::pi : around.bearings[i + 1].angle;
    const double gap = next - around.bearings[i].angle;
    second = std::max(second, std::min(gap, widest));
    if (gap <= widest) continue;
    widest = gap;
    middle = 0.5 * (next + around.bearings[i].angle);
  }
  if (widest <= kOpenAngle || second >= kSecondOpenAngle) return glm::dvec3(0);
  return std::cos(middle) * around.e0 + std::sin(middle) * around.e1;
}

/// What the radius of a point follows from.
struct Surroundings {
  double reach = 0;
  glm::dvec3 opening{0};
};

std::vector<double> disc_radii(const Neighbours& neighbours, const std::vector<Shape>& shapes) {
  std::vector<Surroundings> surroundings(shapes.size());
  tbb::parallel_for(size_t{0}, shapes.size(), [&](size_t i) {
    const Around arranged = around(neighbours, i, shapes[i].normal);
    surroundings[i] = {reach_of(arranged.bearings), opening_of(arranged)};
  });
  std::vector<double> own(shapes.size());
  tbb::parallel_for(size_t{0}, shapes.size(), [&](size_t i) {
    const std::span<const uint32_t> nearest = neighbours.of(i, kNearest);
    const double limit = kLargestRatio * neighbours.distance(i, std::min<size_t>(2, nearest.size() - 1));
    double sum = 0;
    size_t same_side = 0;
    for (size_t k = 0; k < nearest.size(); ++k) {
      sum += std::min(neighbours.distance(i, k), limit);
      same_side += glm::dot(surroundings[i].opening, surroundings[nearest[k]].opening) > kSameSide ? 1 : 0;
    }
    const double mean = sum / static_cast<double>(nearest.size());
    own[i] = same_side >= kAgreeingBorders ? kBorderShare * mean
                                           : std::max(mean, kReachShare * std::min(surroundings[i].reach, limit));
  });
  std::vector<double> radii(shapes.size());
  tbb::parallel_for(size_t{0}, shapes.size(), [&](size_t i) {
    std::array<double, kNearest> around_it{};
    const std::span<const uint32_t> nearest = neighbours.of(i, kNearest);
    const auto end = std::ranges::transform(nearest, around_it.begin(), [&](uint32_t j) { return own[j]; }).out;
    std::sort(around_it.begin(), end);
    radii[i] = std::min(own[i], kLargestRatio * around_it[nearest.size() / 2]);
  });
  return radii;
}

/// For each point, the median radius of the discs on the surfaces around; infinite if there are no surfaces.
std::vector<double> spacing_around(std::span<const glm::dvec3> points, const std::vector<WitnessPoint>& witness,
                                   const std::vector<double>& radii) {
  std::vector<glm::dvec3> sample;
  std::vector<double> sampled_radii;
  size_t surfaces = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    if (!witness[i].surface || surfaces++ % kSampling != 0) continue;
    sample.push_back(points[i]);
    sampled_radii.push_back(radii[i]);
  }
  std::vector<double> spacings(points.size(), std::numeric_limits<double>::infinity());
  if (sample.empty()) return spacings;
  const NearestPoints nearest = nearest_points(sample, points, kSamples);
  tbb::parallel_for(size_t{0}, points.size(), [&](size_t i) {
    std::vector<double> found;
    for (const uint32_t j : nearest.of(i)) found.push_back(sampled_radii[j]);
    std::ranges::sort(found);
    spacings[i] = found[found.size() / 2];
  });
  return spacings;
}

/// A disc or splat in the camera frame.
struct CameraDisc {
  glm::dvec3 centre;
  glm::dvec3 normal;
  double radius = 0;
};

CameraDisc in_camera(const glm::dvec3& point, const WitnessPoint& shown, const geometry::CameraFrame& frame) {
  const glm::dvec3 centre = frame.to_camera(point);
  return {centre, shown.surface ? frame.rotate(shown.normal) : kinds::facing_eye(centre), shown.radius};
}

}  // namespace

std::vector<WitnessPoint> make_witness(std::span<const glm::dvec3> points) {
  SURFCAST_EXPECTS(points.size() >= 2);
  const Neighbours neighbours(points);
  std::vector<WitnessPoint> witness(points.size());
  std::vector<Shape> shapes(points.size());
  tbb::parallel_for(size_t{0}, points.size(), [&](size_t i) {
    const size_t count = neighbours.of(i, kNearest).size();
    for (size_t k = 0; k < count; ++k) witness[i].spacing += neighbours.distance(i, k) / static_cast<double>(count);
    shapes[i] = shape_of(neighbours, i, witness[i].spacing);
    witness[i].normal = shapes[i].normal;
  });
  for (size_t i = 0; i < points.size(); ++i) {
    witness[i].surface = shapes[i].flat && agrees_with_peers(neighbours, shapes, i);
  }
  const std::vector<double> radii = disc_radii(neighbours, shapes);
  const std::vector<double> limits = spacing_around(points, witness, radii);
  for (size_t i = 0; i < points.size(); ++i) {
    witness[i].radius = witness[i].surface ? std::min(kDiscFactor * radii[i], kDiscLimit * limits[i])
                                           : kSplatFactor * neighbours.distance(i, 0);
  }
  return witness;
}

DepthPicture witness_depths(std::span<const glm::dvec3> points, std::span<const WitnessPoint> witness,
                            const geometry::CameraFrame& frame) {
  std::vector<CameraDisc> discs;
  std::vector<PixelBox> boxes;
  for (size_t i = 0; i < points.size(); ++i) {
    const CameraDisc disc = in_camera(points[i], witness[i], frame);
    const PixelBox box = pixels_within(frame, disc.centre, kLargestExtent * disc.radius, kPrefilterReach);
    if (box.empty()) continue;
    discs.push_back(disc);
    boxes.push_back(box);
  }
  DepthPicture picture(frame.width, frame.height);
  for_each_pixel(boxes, frame.height, [&](size_t i, int x, int y) {
    const CameraDisc& disc = discs[i];
    const auto hit = kinds::hit_disc(disc.centre, disc.normal, disc.radius, frame.ray({x + 0.5, y + 0.5}), frame.eta);
    float& nearest = picture.depths[picture.index(x, y)];
    if (hit) nearest = std::min(nearest, static_cast<float>(hit->surface));
  });
  return picture;
}

}  // namespace surfcast::lab
