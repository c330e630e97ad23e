#include "ellipsoid/tensor.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace surfcast::ellipsoid {
namespace {

/// Classical Jacobi rotations in extended precision: always the largest entry, until nothing is left.
std::array<long double, 3> reference_values(const SymmetricTensor& t) {
  long double a[3][3] = {{t.xx, t.xy, t.xz}, {t.xy, t.yy, t.yz}, {t.xz, t.yz, t.zz}};
  for (int step = 0; step < 200; ++step) {
    int p = 0;
    int q = 1;
    for (const auto& [i, j] : {std::pair{0, 2}, {1, 2}}) {
      if (std::fabs(a[i][j]) > std::fabs(a[p][q])) p = i, q = j;
    }
    if (a[p][q] == 0) break;
    const long double angle = 0.5L * std::atan2(2 * a[p][q], a[q][q] - a[p][p]);
    const long double c = std::cos(angle);
    const long double s = std::sin(angle);
    for (auto& row : a) {
      const long double x = row[p];
      const long double y = row[q];
      row[p] = c * x - s * y;
      row[q] = s * x + c * y;
    }
    for (int k = 0; k < 3; ++k) {
      const long double x = a[p][k];
      const long double y = a[q][k];
      a[p][k] = c * x - s * y;
      a[q][k] = s * x + c * y;
    }
    if (std::fabs(a[p][q]) < 1e-25L * (std::fabs(a[0][0]) + std::fabs(a[1][1]) + std::fabs(a[2][2]))) {
      a[p][q] = a[q][p] = 0;
    }
  }
  std::array<long double, 3> values{a[0][0], a[1][1], a[2][2]};
  std::sort(values.begin(), values.end(), std::greater<>());
  return values;
}

double largest_entry(const SymmetricTensor& t) {
  double largest = 0;
  for (const double entry : {t.xx, t.xy, t.xz, t.yy, t.yz, t.zz}) largest = std::max(largest, std::abs(entry));
  return largest;
}

/// Values as in extended precision, right-handed unit axes, and the tensor again, all to a few roundings.
void check_system(const SymmetricTensor& tensor) {
  const EigenSystem system = eigen_system(tensor);
  const double scale = largest_entry(tensor);
  const double tolerance = 16 * std::numeric_limits<double>::epsilon();
  const auto values = reference_values(tensor);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LE(std::abs(system.values[i] - static_cast<double>(values[static_cast<size_t>(i)])), tolerance * scale);
  }
  EXPECT_GE(system.values.x, system.values.y);
  EXPECT_GE(system.values.y, system.values.z);
  EXPECT_NEAR(glm::determinant(system.axes), 1, 1e-14);
  const SymmetricTensor again = tensor_of(system.values, system.axes);
  for (const auto& [a, b] : {std::pair{again.xx, tensor.xx},
                             {again.xy, tensor.xy},
                             {again.xz, tensor.xz},
                             {again.yy, tensor.yy},
                             {again.yz, tensor.yz},
                             {again.zz, tensor.zz}}) {
    EXPECT_LE(std::abs(a - b), tolerance * scale);
  }
}

class RandomTensors : public ::testing::Test {
 protected:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  glm::dmat3 rotation() {
    return glm::mat3_cast(glm::normalize(glm::dquat(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1))));
  }
  std::mt19937 random_{5};
};

TEST_F(RandomTensors, HaveTheValuesOfExtendedPrecision) {
  for (int i = 0; i < 2000; ++i) {
    check_system({uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
  }
}

TEST_F(RandomTensors, WithAspectsUpToAMillionHaveThem) {
  for (int i = 0; i < 500; ++i) {
    check_system(tensor_of({1, std::pow(10, uniform(-6, 0)), std::pow(10, uniform(-6, 0))}, rotation()));
  }
}

TEST_F(RandomTensors, WithEqualValuesHaveRightHandedAxes) {
  for (int i = 0; i < 200; ++i) {
    check_system(tensor_of({2, 2, 1}, rotation()));
    check_system(tensor_of({2, 1, 1}, rotation()));
    check_system(tensor_of({1, 1, 1}, rotation()));
    check_system(tensor_of({1, 1 - 1e-15, 1 - 2e-15}, rotation()));
  }
}

TEST_F(RandomTensors, OfAnySignAndSizeHaveThem) {
  for (const double size : {1e-300, 1e-12, 1e12, 1e300}) {
    check_system(tensor_of({-size, -0.5 * size, -0.25 * size}, rotation()));
    check_system(tensor_of({size, 0, -size}, rotation()));
  }
  check_system({0, 1e-308, 0, 0, 0, 1});
}

TEST(EigenSystemTest, OfADiagonalTensorHasTheAxesOfTheWorld) {
  const EigenSystem system = eigen_system({1, 0, 0, 3, 0, 2});
  EXPECT_EQ(system.values, glm::dvec3(3, 2, 1));
  EXPECT_EQ(glm::abs(system.axes[0]), glm::dvec3(0, 1, 0));
  EXPECT_EQ(glm::abs(system.axes[1]), glm::dvec3(0, 0, 1));
  EXPECT_EQ(eigen_system({5, 0, 0, 5, 0, 5}).axes, glm::dmat3(1));
}

TEST(EigenSystemTest, OfNothingIsNothing) {
  EXPECT_EQ(eigen_system({}), EigenSystem());
}

TEST(EigenSystemTest, OfTwoByTwoIsTheClosedForm) {
  // xx = yy = 2, xy = 1: 3 along (1, 1, 0), 1 along (1, -1, 0).
  const EigenSystem system = eigen_system({2, 1, 0, 2, 0, 0.5});
  EXPECT_NEAR(system.values.x, 3, 1e-15);
  EXPECT_NEAR(system.values.y, 1, 1e-15);
  EXPECT_EQ(system.values.z, 0.5);
  EXPECT_NEAR(std::abs(glm::dot(system.axes[0], glm::normalize(glm::dvec3(1, 1, 0)))), 1, 1e-15);
}

TEST(InvariantsTest, OfNeedlesDiscsAndBallsAreKnown) {
  EXPECT_NEAR(fractional_anisotropy({1, 0, 0}), 1, 1e-15);
  EXPECT_NEAR(mode_of({1, 0, 0}), 1, 1e-15);
  EXPECT_NEAR(fractional_anisotropy({1, 1, 0}), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(mode_of({1, 1, 0}), -1, 1e-15);
  EXPECT_EQ(fractional_anisotropy({2, 2, 2}), 0);
  EXPECT_EQ(mode_of({2, 2, 2}), 0) << "an isotropic tensor has no mode";
  EXPECT_NEAR(mode_of({3, 2, 1}), 0, 1e-15);
  EXPECT_NEAR(fractional_anisotropy({1.7e-9, 0.3e-9, 0.2e-9}), 0.83587, 1e-5);
  EXPECT_EQ(fractional_anisotropy({0, 0, 0}), 0);
  EXPECT_NEAR(fractional_anisotropy({1e300, 1e299, 1e299}), fractional_anisotropy({1, 0.1, 0.1}), 1e-15);
  EXPECT_NEAR(mean_value({3, 2, 1}), 2, 1e-15);
}

TEST(MeasurementFrameTest, HasItsAxesInItsColumns) {
  // A needle along x of a frame whose x is the world's z.
  const glm::dmat3 frame{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
  const SymmetricTensor world = turned({3, 0, 0, 2, 0, 1}, frame);
  EXPECT_EQ(world.zz, 3);
  EXPECT_EQ(world.xx, 2);
  EXPECT_EQ(world.yy, 1);
}

}  // namespace
}  // namespace surfcast::ellipsoid
