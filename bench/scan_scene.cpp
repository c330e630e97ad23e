#include "scan_scene.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <optional>
#include <tuple>
#include <utility>

#include "scan_forest.h"
#include "scan_random.h"

namespace surfcast::bench {
namespace {

constexpr double kBlock = 40;          // metres, street included
constexpr double kStreet = 7;          // width of the streets between blocks
constexpr double kRangeNoise = 0.012;  // standard deviation, metres

// ---- ground

double ground_height(const glm::dvec2& p) {
  return 40 * noise(p / 400.0) + 9 * noise(p / 90.0) + 0.25 * noise(p / 4.0) + 120;
}

// ---- houses and trees

struct House {
  glm::dvec2 centre;
  glm::dvec2 half;   ///< of the footprint
  double floor = 0;  ///< height of the ground under it
  double eaves = 0;  ///< height of the upper end of the walls
  double ridge = 0;  ///< height of the roof above the eaves; 0 for a flat one
  glm::dvec3 wall{0};
  glm::dvec3 roof{0};

  [[nodiscard]] bool covers(const glm::dvec2& p) const {
    const glm::dvec2 d = glm::abs(p - centre);
    return d.x <= half.x && d.y <= half.y;
  }
  [[nodiscard]] double roof_height(const glm::dvec2& p) const {
    return eaves + ridge * (1 - std::abs(p.y - centre.y) / half.y);
  }
};

struct Tree {
  glm::dvec2 foot;
  double radius = 0;
  double middle = 0;  ///< height of the crown's centre
  double tall = 0;    ///< half the height of the crown
  glm::dvec3 leaf{0};
};

struct BlockKey {
  int64_t x = 0;
  int64_t y = 0;

  [[nodiscard]] uint64_t seed(uint64_t purpose) const {
    return mix(static_cast<uint64_t>(x) << 40 ^ static_cast<uint64_t>(y) << 16 ^ purpose);
  }
  [[nodiscard]] glm::dvec2 centre() const {
    return {(static_cast<double>(x) + 0.5) * kBlock, (static_cast<double>(y) + 0.5) * kBlock};
  }
};

BlockKey block_of(const glm::dvec2& p) {
  return {static_cast<int64_t>(std::floor(p.x / kBlock)), static_cast<int64_t>(std::floor(p.y / kBlock))};
}

std::optional<House> house_on(const BlockKey& block) {
  Dice dice(block.seed(1));
  if (dice.uniform() > 0.55) return std::nullopt;
  House house;
  house.centre = block.centre() + glm::dvec2(dice.between(-2, 2), dice.between(-2, 2));
  house.half = {dice.between(6, 12), dice.between(5, 9)};
  house.floor = ground_height(house.centre);
  house.eaves = house.floor + dice.between(5, 18);
  house.ridge = dice.uniform() < 0.7 ? dice.between(2.5, 5) : 0;
  house.wall = glm::mix(glm::dvec3(0.85, 0.78, 0.62), glm::dvec3(0.72, 0.72, 0.74), dice.uniform());
  house.roof = house.ridge > 0 ? glm::mix(glm::dvec3(0.62, 0.25, 0.16), glm::dvec3(0.36, 0.2, 0.18), dice.uniform())
                               : glm::dvec3(dice.between(0.35, 0.6));
  return house;
}

constexpr uint64_t kTrees = 6;

/// Tree `number` of a block, if there is one. Blocks with a house have fewer trees.
std::optional<Tree> tree_on(const BlockKey& block, uint64_t number, bool beside_house) {
  Dice dice(block.seed(100 + number));
  if (dice.uniform() < (beside_house ? 0.7 : 0.35)) return std::nullopt;
  Tree tree;
  const double reach = 0.5 * (kBlock - kStreet);
  tree.foot = block.centre() + glm::dvec2(dice.between(-reach, reach), dice.between(-reach, reach));
  tree.radius = dice.between(1.8, 4.5);
  tree.tall = tree.radius * dice.between(0.9, 1.5);
  tree.middle = ground_height(tree.foot) + tree.tall + dice.between(1.5, 3);
  tree.leaf = glm::mix(glm::dvec3(0.18, 0.34, 0.1), glm::dvec3(0.42, 0.5, 0.16), dice.uniform());
  return tree;
}

// ---- echoes

glm::dvec3 ground_color(const glm::dvec2& p) {
  const glm::dvec2 in_block = glm::abs(p - block_of(p).centre());
  const double to_street = 0.5 * (kBlock - kStreet) - std::max(in_block.x, in_block.y);
  if (to_street < 0) return glm::dvec3(to_street > -0.6 ? 0.62 : 0.33 + 0.05 * noise(p / 2.0));
  return glm::mix(glm::dvec3(0.33, 0.43, 0.17), glm::dvec3(0.52, 0.47, 0.3), noise(p / 15.0));
}

Echo ground_echo(const glm::dvec2& p, Dice& dice) {
  Echo echo;
  echo.position = {p, ground_height(p)};
  echo.classification = 2;
  paint(echo, ground_color(p), 0.06, dice);
  return echo;
}

Echo roof_echo(const House& house, const glm::dvec2& p, Dice& dice) {
  Echo echo;
  echo.position = {p, house.roof_height(p)};
  echo.classification = 6;
  // Rows of tiles.
  const double row = house.ridge > 0 && std::fmod(p.y, 0.4) < 0.06 ? 0.8 : 1;
  paint(echo, house.roof * row, 0.05, dice);
  return echo;
}

/// A random point on the four walls, gables included, uniform along the perimeter.
Echo wall_echo(const House& house, Dice& dice) {
  Echo echo;
  echo.classification = 6;
  const bool along_x = dice.uniform() * (house.half.x + house.half.y) < house.half.x;
  const double side = dice.uniform() < 0.5 ? -1 : 1;
  const double along = dice.between(-1, 1);
  const glm::dvec2 offset = along_x ? glm::dvec2(along, side) * house.half : glm::dvec2(side, along) * house.half;
  const glm::dvec2 foot = house.centre + offset;
  const double low = std::min(house.floor, ground_height(foot)) - 0.1;
  const double top = house.roof_height(foot);
  const double up = dice.uniform();
  echo.position = {foot, low + up * (top - low)};
  const double storey = std::fmod(echo.position.z - house.floor + 30, 3.0);
  const double bay = std::fmod(std::abs(along_x ? foot.x : foot.y), 2.5);
  const bool window = storey > 1 && storey < 2.3 && bay > 0.7 && bay < 1.9 && echo.position.z < house.eaves - 0.4;
  paint(echo, window ? glm::dvec3(0.16, 0.2, 0.25) : house.wall, 0.04, dice);
  return echo;
}

/// An echo of a crown from above. The pulse penetrates the hull by a random depth before it hits a leaf.
Echo crown_echo(const Tree& tree, const glm::dvec2& p, Dice& dice) {
  Echo echo;
  const glm::dvec2 d = (p - tree.foot) / tree.radius;
  const double hull = tree.tall * std::sqrt(std::max(0.0, 1 - glm::dot(d, d)));
  const double depth = std::min(1.9, -0.25 * std::log(1 - dice.uniform()));
  echo.position = {p, tree.middle + hull * (1 - depth) + 0.15 * dice.gaussian()};
  echo.classification = 5;
  echo.returns = 2;
  paint(echo, tree.leaf * (1.15 - 0.4 * depth), 0.15, dice);
  return echo;
}

uint64_t rows_of_scan(uint64_t count) {
  return static_cast<uint64_t>(std::max(1.0, std::sqrt(static_cast<double>(count))));
}

Echo echo_from_above(const glm::dvec2& p, const BlockKey& block, const std::optional<House>& house, Dice& dice) {
  if (house && house->covers(p)) return roof_echo(*house, p, dice);
  for (uint64_t i = 0; i < kTrees; ++i) {
    const std::optional<Tree> tree = tree_on(block, i, house.has_value());
    if (!tree || glm::distance(tree->foot, p) > tree->radius) continue;
    if (dice.uniform() < 0.75) return crown_echo(*tree, p, dice);
    Echo ground = ground_echo(p, dice);
    ground.return_number = ground.returns = 2;
    return ground;
  }
  return ground_echo(p, dice);
}

Echo town_echo(const glm::dvec2& p, Dice& dice) {
  const BlockKey block = block_of(p);
  const std::optional<House> house = house_on(block);
  return house && dice.uniform() < 0.3 ? wall_echo(*house, dice) : echo_from_above(p, block, house, dice);
}

}  // namespace

ScanPart part_of_scan(uint64_t count, double x, double y, double side) {
  const uint64_t rows = rows_of_scan(count);
  ScanPart part{.count = count, .columns = (count + rows - 1) / rows};
  const auto range = [side](double low, uint64_t cells) {
    const double share = static_cast<double>(cells) / kSceneSide;
    const auto cell = [&](double metres) {
      return static_cast<uint64_t>(std::clamp(std::round(metres * share), 0.0, static_cast<double>(cells)));
    };
    return std::pair(cell(low), cell(low + side) - cell(low));
  };
  std::tie(part.first_column, part.width) = range(x, part.columns);
  std::tie(part.first_row, part.rows) = range(y, rows);
  if (part.width == 0 || part.rows == 0) return part;
  const uint64_t end = (part.first_row + part.rows - 1) * part.columns + part.first_column + part.width;
  part.last = end > count ? std::min(end - count, part.width) : 0;
  return part;
}

Echo scan_echo(uint64_t index, uint64_t count, Landscape landscape) {
  const uint64_t rows = rows_of_scan(count);
  const uint64_t columns = (count + rows - 1) / rows;
  Dice dice(index ^ count << 32);
  const glm::dvec2 place((static_cast<double>(index % columns) + dice.uniform()) / static_cast<double>(columns),
                         (static_cast<double>(index / columns) + dice.uniform()) / static_cast<double>(rows));
  const glm::dvec2 p = glm::min(place, 1.0) * kSceneSide;
  Echo echo = landscape == Landscape::kForest ? forest_echo(p, dice) : town_echo(p, dice);
  echo.position += kRangeNoise * glm::dvec3(dice.gaussian(), dice.gaussian(), dice.gaussian());
  echo.position = glm::max(echo.position, 0.0);
  return echo;
}

}  // namespace surfcast::bench
