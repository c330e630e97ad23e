#include "scan_forest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

namespace surfcast::bench {
namespace {

// ---- the fort on the ground

const glm::dvec2 kFort(0.5 * kSceneSide);  // its middle, metres

struct Foundation {
  glm::dvec2 centre;  ///< from the middle of the fort
  glm::dvec2 half;
};
const std::array<Foundation, 6> kFoundations{{{{-9, 7}, {5, 3}},
                                              {{3, 10}, {3.5, 3}},
                                              {{-10, -6}, {3, 4.5}},
                                              {{1, -11}, {5, 2.8}},
                                              {{11, -4}, {3, 3}},
                                              {{0, -1}, {3.5, 2.5}}}};

/// 1 on a line, and less beside it.
double ridge(double off, double width) {
  return std::exp(-off * off / (width * width));
}

/// 1 on the walls of a foundation.
double walls(const glm::dvec2& d) {
  double most = 0;
  for (const Foundation& foundation : kFoundations) {
    const glm::dvec2 out = glm::abs(d - foundation.centre) - foundation.half;
    most = std::max(most, ridge(std::max(out.x, out.y), 0.4));
  }
  return most;
}

/// 1 on the way through the gate.
double way(const glm::dvec2& d) {
  return d.x > 0 ? ridge(d.y - 3 * std::sin(d.x / 25), 2.2) * std::clamp((d.x - 14) / 6, 0.0, 1.0) : 0;
}

double forest_floor(const glm::dvec2& p) {
  const glm::dvec2 d = p - kFort;
  const double r = glm::length(d) + 3 * noise(p / 14.0);
  const double rings = 2.6 * ridge(r - 25, 2.2) - 1.9 * ridge(r - 30.5, 2.6) + 1.5 * ridge(r - 36, 2);
  return 130 + 7 * ridge(r, 50) + 5 * noise(p / 60.0) + 0.2 * noise(p / 2.5) + rings * (1 - way(d)) + 0.8 * walls(d);
}

/// Light of a low sun, which makes banks stand out.
double sunshine(const glm::dvec2& p) {
  constexpr double kStep = 0.3;
  const double east = forest_floor(p + glm::dvec2(kStep, 0)) - forest_floor(p - glm::dvec2(kStep, 0));
  const double north = forest_floor(p + glm::dvec2(0, kStep)) - forest_floor(p - glm::dvec2(0, kStep));
  const glm::dvec3 normal = glm::normalize(glm::dvec3(-east, -north, 2 * kStep));
  return 0.35 + 0.75 * std::max(0.0, glm::dot(normal, glm::normalize(glm::dvec3(-0.7, 0.5, 0.8))));
}

Echo floor_echo(const glm::dvec2& p, Dice& dice) {
  const glm::dvec2 d = p - kFort;
  const glm::dvec3 litter = glm::mix(glm::dvec3(0.62, 0.45, 0.26), glm::dvec3(0.7, 0.56, 0.36), noise(p / 5.0));
  const glm::dvec3 trodden = glm::mix(litter, glm::dvec3(0.86, 0.77, 0.58), way(d));
  Echo echo;
  echo.position = {p, forest_floor(p)};
  echo.classification = 2;
  paint(echo, sunshine(p) * glm::mix(trodden, glm::dvec3(0.8, 0.79, 0.75), walls(d)), 0.05, dice);
  return echo;
}

// ---- trees

constexpr double kCell = 5;  // with a tree each, metres

struct ForestTree {
  glm::dvec2 foot;
  double radius = 0;
  double middle = 0;  ///< height of the crown's centre
  double tall = 0;    ///< half the height of the crown
  glm::dvec3 leaf{0};

  /// Height of the crown's hull above its centre; negative beside the tree.
  [[nodiscard]] double hull(const glm::dvec2& p) const {
    const glm::dvec2 d = (p - foot) / radius;
    const double square = 1 - glm::dot(d, d);
    return square > 0 ? tall * std::sqrt(square) : -1;
  }
};

ForestTree tree_in(const glm::dvec2& cell) {
  Dice dice(mix(static_cast<uint64_t>(cell.x) << 32 ^ static_cast<uint64_t>(cell.y)));
  ForestTree tree;
  tree.foot = (cell + glm::dvec2(dice.between(0.2, 0.8), dice.between(0.2, 0.8))) * kCell;
  tree.radius = dice.between(2.9, 4.6);
  tree.tall = tree.radius * dice.between(0.9, 1.4);
  tree.middle = forest_floor(tree.foot) + tree.tall + dice.between(3, 6);
  tree.leaf = glm::mix(glm::dvec3(0.2, 0.38, 0.12), glm::dvec3(0.5, 0.56, 0.18), dice.uniform());
  return tree;
}

/// The tree whose crown is the highest over p.
std::optional<ForestTree> tree_over(const glm::dvec2& p) {
  std::optional<ForestTree> highest;
  const glm::dvec2 own = glm::floor(p / kCell);
  for (int i = 0; i < 9; ++i) {
    const ForestTree tree = tree_in(glm::max(own + glm::dvec2(i % 3 - 1, i / 3 - 1), 0.0));
    if (tree.hull(p) < 0) continue;
    if (!highest || tree.middle + tree.hull(p) > highest->middle + highest->hull(p)) highest = tree;
  }
  return highest;
}

/// The pulse penetrates the hull by a random depth before it hits a leaf.
Echo leaf_echo(const ForestTree& tree, const glm::dvec2& p, Dice& dice) {
  const double depth = std::min(1.9, -0.1 * std::log(1 - dice.uniform()));
  Echo echo;
  echo.position = {p, tree.middle + tree.hull(p) * (1 - depth) + 0.15 * dice.gaussian()};
  echo.classification = 5;
  echo.returns = 2;
  paint(echo, tree.leaf * (1.15 - 0.4 * depth), 0.15, dice);
  return echo;
}

}  // namespace

Echo forest_echo(const glm::dvec2& p, Dice& dice) {
  const std::optional<ForestTree> tree = tree_over(p);
  if (tree && dice.uniform() < 0.7) return leaf_echo(*tree, p, dice);
  Echo echo = floor_echo(p, dice);
  if (tree) echo.return_number = echo.returns = 2;
  return echo;
}

}  // namespace surfcast::bench
