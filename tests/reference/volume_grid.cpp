#include "reference/volume_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <numbers>

namespace surfcast::reference {
namespace {

constexpr int kTapReach = 4;  ///< spacings; a kernel of 0.6 has fallen to 1e-10 there

size_t place_of(const glm::ivec3& size, const glm::ivec3& i) {
  return (static_cast<size_t>(i.z) * size.y + i.y) * size.x + i.x;
}

template <typename Visit>
void for_each_index(const glm::ivec3& size, const Visit& visit) {
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) visit(glm::ivec3(x, y, z));
    }
  }
}

/// Faces at the first and last samples, and half a spacing beyond an only sample.
void set_faces(VolumeGrid& grid) {
  for (int i = 0; i < 3; ++i) {
    grid.low[i] = grid.size[i] > 1 ? 0 : -0.5;
    grid.high[i] = grid.size[i] > 1 ? grid.size[i] - 1 : 0.5;
  }
}

VolumeGrid convolved(const VolumeGrid& grid, int axis, double sigma) {
  VolumeGrid result = grid;
  for_each_index(grid.size, [&](const glm::ivec3& i) {
    double sum = 0;
    glm::ivec3 at = i;
    for (int m = -kTapReach; m <= kTapReach; ++m) {
      at[axis] = i[axis] + m;
      sum += tap(m, sigma) * grid.at(at);
    }
    result.values[place_of(grid.size, i)] = sum;
  });
  return result;
}

/// Weighted sum over 4 samples along each axis about `index`.
template <typename Weights>
double separable_sum(const VolumeGrid& grid, const glm::dvec3& index, const Weights& weights) {
  const glm::dvec3 base = glm::floor(index);
  std::array<std::array<double, 4>, 3> w{};
  for (int i = 0; i < 3; ++i) w[i] = weights(index[i] - base[i]);
  double sum = 0;
  for_each_index({4, 4, 4}, [&](const glm::ivec3& k) {
    const double weight = w[0][k.x] * w[1][k.y] * w[2][k.z];
    if (weight != 0) sum += weight * grid.at(glm::ivec3(base) + k - 1);
  });
  return sum;
}

}  // namespace

double VolumeGrid::at(const glm::ivec3& i) const {
  return values[place_of(size, glm::clamp(i, glm::ivec3(0), size - 1))];
}

double VolumeGrid::spacing_along(const glm::dvec3& direction) const {
  return 1 / glm::length(glm::inverse(axes) * direction);
}

VolumeGrid make_grid(const glm::ivec3& size, const glm::dvec3& origin, const glm::dmat3& axes,
                     const std::function<double(const glm::dvec3& place)>& value) {
  VolumeGrid grid{size, origin, axes, {}, {}, {}};
  set_faces(grid);
  for_each_index(size, [&](const glm::ivec3& i) { grid.values.push_back(value(grid.place(glm::dvec3(i)))); });
  return grid;
}

VolumeGrid sampled(const VolumeField& field, const glm::ivec3& size) {
  const glm::dvec3 step = 2.0 / (glm::dvec3(size) - 1.0);
  const glm::dmat3 axes{{step.x, 0, 0}, {0, step.y, 0}, {0, 0, step.z}};
  return make_grid(size, glm::dvec3(-1), axes, field.value);
}

VolumeGrid halved(const VolumeGrid& grid) {
  VolumeGrid result;
  result.size = (grid.size + 1) / 2;
  result.origin = grid.place(glm::dvec3(0.5));
  result.axes = 2.0 * grid.axes;
  result.low = 0.5 * grid.low - 0.25;
  result.high = 0.5 * grid.high - 0.25;
  for_each_index(result.size, [&](const glm::ivec3& i) {
    double sum = 0;
    for_each_index({2, 2, 2}, [&](const glm::ivec3& k) { sum += grid.at(2 * i + k); });
    result.values.push_back(sum / 8);
  });
  return result;
}

double tap(int m, double sigma) {
  const auto weight = [&](int i) { return std::exp(-0.5 * i * i / (sigma * sigma)); };
  double sum = 0;
  for (int i = -kTapReach; i <= kTapReach; ++i) sum += weight(i);
  return weight(m) / sum;
}

VolumeGrid corrected(const VolumeGrid& grid, double sigma, int times) {
  VolumeGrid result = grid;
  for (int n = 0; n < times; ++n) {
    VolumeGrid drawn = result;
    for (int axis = 0; axis < 3; ++axis) drawn = convolved(drawn, axis, sigma);
    for (size_t i = 0; i < grid.values.size(); ++i) result.values[i] += grid.values[i] - drawn.values[i];
  }
  return result;
}

std::vector<glm::dvec3> sample_gradients(const VolumeGrid& grid) {
  const glm::dmat3 to_world = glm::transpose(glm::inverse(grid.axes));
  std::vector<glm::dvec3> gradients;
  for_each_index(grid.size, [&](const glm::ivec3& i) {
    glm::dvec3 difference;
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 step{0};
      step[axis] = 1;
      difference[axis] = 0.5 * (grid.at(i + step) - grid.at(i - step));
    }
    gradients.push_back(to_world * difference);
  });
  return gradients;
}

double trilinear(const VolumeGrid& grid, const glm::dvec3& index) {
  return separable_sum(grid, index, [](double x) { return std::array<double, 4>{0, 1 - x, x, 0}; });
}

double catmull_rom(const VolumeGrid& grid, const glm::dvec3& index) {
  return separable_sum(grid, index, [](double x) {
    const double x2 = x * x;
    const double x3 = x2 * x;
    return std::array<double, 4>{0.5 * (-x3 + 2 * x2 - x), 0.5 * (3 * x3 - 5 * x2 + 2), 0.5 * (-3 * x3 + 4 * x2 + x),
                                 0.5 * (x3 - x2)};
  });
}

double gaussian_sum(const VolumeGrid& coefficients, double sigma, const glm::dvec3& index) {
  const double peak = std::pow(2 * std::numbers::pi * sigma * sigma, -1.5);
  const glm::ivec3 nearest = glm::ivec3(glm::round(index));
  double sum = 0;
  for_each_index(glm::ivec3(2 * kTapReach + 1), [&](const glm::ivec3& k) {
    const glm::ivec3 i = nearest + k - kTapReach;
    const glm::dvec3 d = (index - glm::dvec3(i)) / sigma;
    sum += peak * std::exp(-0.5 * glm::dot(d, d)) * coefficients.at(i);
  });
  return sum;
}

}  // namespace surfcast::reference
