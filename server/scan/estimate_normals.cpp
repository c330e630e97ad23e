#include "scan/estimate_normals.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

namespace surfcast::scan {
namespace {

/// Covariance of the site and its neighbours, scaled to a trace of 1.
Eigen::Matrix3d covariance(const Sites& sites, size_t site, std::span<const uint32_t> neighbours) {
  const glm::dvec3 centre = sites.positions[site];
  glm::dvec3 sum(0);
  glm::dvec3 squares(0);   // sums of x x, y y and z z
  glm::dvec3 products(0);  // sums of y z, z x and x y
  for (const uint32_t j : neighbours) {
    const glm::dvec3 d = sites.positions[j] - centre;
    sum += d;
    squares += d * d;
    products += glm::dvec3(d.y * d.z, d.z * d.x, d.x * d.y);
  }
  const glm::dvec3 mean = sum / static_cast<double>(neighbours.size() + 1);
  squares -= sum * mean;
  products -= glm::dvec3(sum.y * mean.z, sum.z * mean.x, sum.x * mean.y);
  const double trace = squares.x + squares.y + squares.z;  // positive: there are two distinct sites
  Eigen::Matrix3d matrix;
  matrix << squares.x, products.z, products.y, products.z, squares.y, products.x, products.y, products.x, squares.z;
  return matrix / trace;
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
