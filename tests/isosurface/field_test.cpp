#include "isosurface/field.h"

#include <cmath>

#include <gtest/gtest.h>

namespace surfcast::isosurface {
namespace {

/// All samples of a field over indices.
template <typename Field>
SampleWindow sampled(const Index& size, const Field& field) {
  SampleWindow window(size);
  for (int64_t k = 0; k < size.z; ++k) {
    const std::span<double> plane = window.append();
    for (int64_t j = 0; j < size.y; ++j) {
      for (int64_t i = 0; i < size.x; ++i) plane[static_cast<size_t>(j * size.x + i)] = field(glm::dvec3(i, j, k));
    }
  }
  return window;
}

double quadratic(const glm::dvec3& p) {
  return 2 + p.x - 3 * p.y + 0.5 * p.z * p.z + p.x * p.y;
}

TEST(FieldTest, QuadraticFieldsAreExactAwayFromTheFaces) {
  const SampleWindow window = sampled({6, 7, 8}, quadratic);
  const glm::dvec3 p(2.3, 3.7, 4.1);
  const FieldValue field = field_at(window, p);
  EXPECT_NEAR(field.value, quadratic(p), 1e-12);
  EXPECT_NEAR(field.gradient.x, 1 + p.y, 1e-12);
  EXPECT_NEAR(field.gradient.y, -3 + p.x, 1e-12);
  EXPECT_NEAR(field.gradient.z, p.z, 1e-12);
}

TEST(FieldTest, GoesThroughTheSamplesOfFacesAndCorners) {
  const SampleWindow window = sampled({3, 4, 5}, quadratic);
  for (const glm::dvec3& p : {glm::dvec3(0), glm::dvec3(2, 3, 4), glm::dvec3(0, 3, 2), glm::dvec3(2, 0, 4)}) {
    EXPECT_DOUBLE_EQ(field_at(window, p).value, quadratic(p));
  }
}

TEST(FieldTest, SamplesRepeatBeyondTheFaces) {
  const SampleWindow window = sampled({4, 4, 4}, [](const glm::dvec3& p) { return p.x; });
  EXPECT_NEAR(field_at(window, {0, 1.5, 1.5}).gradient.x, 0.5, 1e-12);
  EXPECT_NEAR(field_at(window, {3, 1.5, 1.5}).gradient.x, 0.5, 1e-12);
}

TEST(FieldTest, AxesOfOneSampleAreFlat) {
  const SampleWindow window = sampled({1, 1, 5}, [](const glm::dvec3& p) { return p.z; });
  const FieldValue field = field_at(window, {0, 0, 1.75});
  EXPECT_NEAR(field.value, 1.75, 1e-12);
  EXPECT_EQ(field.gradient.x, 0);
  EXPECT_EQ(field.gradient.y, 0);
  EXPECT_NEAR(field.gradient.z, 1, 1e-12);
}

TEST(FieldTest, PlanesThatWereDroppedAreNotNeededBehindThem) {
  SampleWindow window = sampled({4, 4, 9}, quadratic);
  const FieldValue before = field_at(window, {1.5, 1.5, 5.5});
  window.drop_before(4);
  EXPECT_EQ(window.first(), 4);
  EXPECT_EQ(window.end(), 9);
  EXPECT_EQ(field_at(window, {1.5, 1.5, 5.5}).value, before.value);
}

}  // namespace
}  // namespace surfcast::isosurface
