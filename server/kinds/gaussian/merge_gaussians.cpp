#include "gaussian/merge_gaussians.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>
#include <numeric>
#include <span>

namespace surfcast::gaussian {
namespace {

constexpr int kCubesAcross = 512;
constexpr int kFewestAcross = 8;
constexpr double kMinReduction = 0.3;

using Matrix = Eigen::Matrix3d;
using Vector = Eigen::Vector3d;

Vector to_eigen(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

Matrix covariance_of(const glm::vec3& scale, const glm::quat& rotation) {
  const glm::dmat3 axes = glm::mat3_cast(glm::dquat(rotation));
  Matrix factor;
  for (int axis = 0; axis < 3; ++axis) factor.col(axis) = to_eigen(axes[axis] * double{scale[axis]});
  return factor * factor.transpose();
}

/// The mean area of the projections of an ellipsoid with these semi-axes: a quarter of its surface (Cauchy), which
/// Thomsen's formula gives within 1.1 %.
double mean_area(const glm::dvec3& axes) {
  constexpr double kPower = 1.6075;
  const glm::dvec3 products =
      glm::pow(glm::dvec3(axes.x * axes.y, axes.x * axes.z, axes.y * axes.z), glm::dvec3(kPower));
  return std::numbers::pi * std::pow((products.x + products.y + products.z) / 3, 1 / kPower);
}

/// Places the cubes of a cell in one order.
uint64_t cube_of(const glm::dvec3& position, const geometry::Box& cell, double side) {
  const auto index = [&](int axis) {
    return static_cast<uint64_t>(std::clamp((position[axis] - cell.min[axis]) / side, 0.0, 65535.0));
  };
  return (index(2) << 32) | (index(1) << 16) | index(0);
}

/// The Gaussians of a cube: a range of the members that are merged.
using Group = std::span<const uint32_t>;

/// Members that stay and groups that become one.
struct Grouping {
  std::vector<uint32_t> kept;
  std::vector<uint32_t> members;  ///< group after group
  std::vector<size_t> ends;       ///< of the groups

  [[nodiscard]] size_t size() const { return kept.size() + ends.size(); }
};

Grouping group_by_cube(const Gaussians& gaussians, const geometry::Box& cell, double side) {
  Grouping grouping;
  std::vector<std::pair<uint64_t, uint32_t>> order;
  for (uint32_t i = 0; i < gaussians.size(); ++i) {
    const glm::vec3& s = gaussians.scales[i];
    const bool large = double{std::max({s.x, s.y, s.z})} > side;
    if (large) grouping.kept.push_back(i);
    if (!large) order.emplace_back(cube_of(gaussians.positions[i], cell, side), i);
  }
  std::sort(order.begin(), order.end());
  for (size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && order[i].first != order[i - 1].first) grouping.ends.push_back(i);
    grouping.members.push_back(order[i].second);
  }
  if (!order.empty()) grouping.ends.push_back(order.size());
  return grouping;
}

/// Sums over a group, weighted.
class Moments {
 public:
  Moments(const Gaussians& gaussians, Group group) : gaussians_(gaussians), group_(group) {
    for (const uint32_t i : group) {
      const double area = mean_area(glm::dvec3(gaussians.scales[i]));
      weights_.push_back(double{gaussians.opacities[i]} * area);
    }
    cover_ = std::accumulate(weights_.begin(), weights_.end(), 0.0);
    if (!(cover_ > 0)) weights_.assign(group.size(), 1);  // nothing that is seen, but still a place
    total_ = std::accumulate(weights_.begin(), weights_.end(), 0.0);
  }

  /// Sum of alpha A.
  [[nodiscard]] double cover() const { return cover_; }
  [[nodiscard]] glm::dvec3 mean() const {
    glm::dvec3 sum(0);
    for (size_t k = 0; k < group_.size(); ++k) sum += weights_[k] * (gaussians_.positions[group_[k]] - origin());
    return origin() + sum / total_;
  }
  [[nodiscard]] Matrix covariance(const glm::dvec3& mean) const {
    Matrix sum = Matrix::Zero();
    for (size_t k = 0; k < group_.size(); ++k) {
      const uint32_t i = group_[k];
      const Vector delta = to_eigen(gaussians_.positions[i] - mean);
      sum += weights_[k] * (covariance_of(gaussians_.scales[i], gaussians_.rotations[i]) + delta * delta.transpose());
    }
    return sum / total_;
  }
  void append_harmonics(size_t width, std::vector<float>& harmonics) const {
    for (size_t c = 0; c < width; ++c) {
      double sum = 0;
      for (size_t k = 0; k < group_.size(); ++k) {
        sum += weights_[k] * double{gaussians_.harmonics[group_[k] * width + c]};
      }
      harmonics.push_back(static_cast<float>(sum / total_));
    }
  }

 private:
  [[nodiscard]] const glm::dvec3& origin() const { return gaussians_.positions[group_.front()]; }

  const Gaussians& gaussians_;
  Group group_;
  std::vector<double> weights_;
  double cover_ = 0;
  double total_ = 0;
};

void append_merged(const Gaussians& from, Group group, const BlockTraits& traits, Gaussians& to) {
  if (group.size() == 1) return append(from, group.front(), to);
  const Moments moments(from, group);
  const glm::dvec3 mean = moments.mean();
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(moments.covariance(mean));
  // Eigenvalues ascend: the last axis is the shortest one, which a disc does not have.
  glm::dmat3 axes(1);
  glm::dvec3 deviations(0);
  for (int axis = 0; axis < 3; ++axis) {
    const Vector v = solver.eigenvectors().col(2 - axis);
    axes[axis] = {v.x(), v.y(), v.z()};
    deviations[axis] = std::sqrt(std::max(0.0, solver.eigenvalues()[2 - axis]));
  }
  axes[2] = glm::cross(axes[0], axes[1]);  // a rotation, not a mirror image
  if (traits.flat) deviations.z = 0;
  const double area = mean_area(deviations);
  to.positions.push_back(mean);
  to.scales.emplace_back(deviations);
  to.rotations.emplace_back(glm::normalize(glm::quat_cast(axes)));
  to.opacities.push_back(area > 0 ? static_cast<float>(-std::expm1(-moments.cover() / area)) : 0);
  moments.append_harmonics(3 * harmonics_of(traits.degree), to.harmonics);
}

}  // namespace

void append(const Gaussians& from, size_t i, Gaussians& to) {
  const size_t width = from.harmonics.size() / from.size();
  to.positions.push_back(from.positions[i]);
  to.scales.push_back(from.scales[i]);
  to.rotations.push_back(from.rotations[i]);
  to.opacities.push_back(from.opacities[i]);
  const auto first = from.harmonics.begin() + static_cast<ptrdiff_t>(i * width);
  to.harmonics.insert(to.harmonics.end(), first, first + static_cast<ptrdiff_t>(width));
}

MergedGaussians merge_gaussians(const Gaussians& gaussians, const BlockTraits& traits, const geometry::Box& cell,
                                size_t most) {
  double side = (cell.max.x - cell.min.x) / kCubesAcross;
  const double widest = (cell.max.x - cell.min.x) / kFewestAcross;
  const auto wanted = static_cast<size_t>(kMinReduction * static_cast<double>(gaussians.size()));
  Grouping grouping = group_by_cube(gaussians, cell, side);
  while (grouping.size() > most || (grouping.size() > wanted && 2 * side <= widest)) {
    side *= 2;
    grouping = group_by_cube(gaussians, cell, side);
  }
  MergedGaussians merged{{}, side};
  for (const uint32_t i : grouping.kept) append(gaussians, i, merged.gaussians);
  for (size_t g = 0, first = 0; g < grouping.ends.size(); first = grouping.ends[g++]) {
    append_merged(gaussians, Group(grouping.members).subspan(first, grouping.ends[g] - first), traits,
                  merged.gaussians);
  }
  return merged;
}

}  // namespace surfcast::gaussian
