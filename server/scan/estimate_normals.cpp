#include "scan/estimate_normals.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

namespace surfcast::scan {
namespace {

/// Covariance of the site and its neighbours, scaled to a trace of 1.
Eigen::Matrix3d covariance(const Sites& sites, size_t site, std::span<const uint32_t> neighbours) {
  const auto difference = [&](uint32_t j) {
    const glm::dvec3 d = sites.positions[j] - sites.positions[site];
    return Eigen::Vector3d(d.x, d.y, d.z);
  };
  // Relative to the farthest neighbour: squares are then of the order of 1 at any scale.
  const double scale = difference(neighbours.back()).cwiseAbs().maxCoeff();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (const uint32_t j : neighbours) {
    const Eigen::Vector3d d = difference(j) / scale;
    mean += d;
    products += d * d.transpose();
  }
  const auto count = static_cast<double>(neighbours.size() + 1);
  products -= mean * mean.transpose() / count;
  return products / products.trace();
}

bool usable(const Eigen::Vector3d& v) {
  return v.allFinite() && std::abs(v.squaredNorm() - 1) < 1e-3;
}

Eigen::Vector3d least_spread(const Eigen::Matrix3d& matrix) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(matrix);  // closed form; the iterative solver below takes five times as long
  if (usable(solver.eigenvectors().col(0))) return solver.eigenvectors().col(0);
  solver.compute(matrix);
  if (usable(solver.eigenvectors().col(0))) return solver.eigenvectors().col(0);
  return Eigen::Vector3d::UnitZ();
}

}  // namespace

std::vector<glm::vec3> estimate_normals(const Sites& sites, const NeighbourGraph& graph) {
  std::vector<glm::vec3> normals(sites.size(), glm::vec3(0, 0, 1));
  if (graph.degree == 0) return normals;
  tbb::parallel_for(size_t{0}, sites.size(), [&](size_t i) {
    const Eigen::Vector3d n = least_spread(covariance(sites, i, graph.of(i))).normalized();
    normals[i] = glm::vec3(glm::dvec3(n.x(), n.y(), n.z()));
  });
  return normals;
}

}  // namespace surfcast::scan
