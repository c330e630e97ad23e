#include "scan/neighbour_spread.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "base/contract.h"

namespace surfcast::scan {

Spread neighbour_spread(const Sites& sites, uint32_t site, std::span<const uint32_t> neighbours) {
  SURFCAST_EXPECTS(!neighbours.empty());
  const auto difference = [&](uint32_t j) {
    const glm::dvec3 d = sites.positions[j] - sites.positions[site];
    return Eigen::Vector3d(d.x, d.y, d.z);
  };
  // Relative to the farthest neighbour: squares are then of the order of 1 at any scale.
  const double inverse = 1 / difference(neighbours.back()).cwiseAbs().maxCoeff();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (const uint32_t j : neighbours) {
    const Eigen::Vector3d d = difference(j) * inverse;
    sum += d;
    products += d * d.transpose();
  }
  const auto count = static_cast<double>(neighbours.size() + 1);
  products -= sum * sum.transpose() / count;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(products, Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& values = solver.eigenvalues();
  // Rounding may leave the least one slightly below 0.
  return {std::max(values[0], 0.0), std::max(values[1], 0.0), values[2]};
}

bool is_scatter(const Sites& sites, uint32_t site, std::span<const uint32_t> neighbours) {
  if (neighbours.size() < kWideNeighbours) return false;
  return !lies_on_surface(neighbour_spread(sites, site, neighbours.first(kNearNeighbours)),
                          neighbour_spread(sites, site, neighbours.first(kWideNeighbours)));
}

}  // namespace surfcast::scan
