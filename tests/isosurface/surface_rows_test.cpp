#include "isosurface/surface_rows.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "isosurface/grid_of_field.h"
#include "model/test_folder.h"
#include "scan/scan_stream.h"
#include "scan/whole_scan.h"

namespace surfcast::isosurface {
namespace {

namespace fs = std::filesystem;
using testing::Field;
using ::testing::HasSubstr;
using testing::unit_cube;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr uint64_t kMemory = uint64_t{1} << 30;

/// Errors of the points of a surface against the field itself.
struct Errors {
  double distance = 0;  ///< root of the mean of the squares, in units of `step`
  double angle = 0;     ///< the same of normals, degrees
};

Errors errors_of(const scan::ScanPoints& points, const Field& field, double value, double step) {
  Errors sums;
  for (size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3 truth = testing::on_surface(field, value, points.positions[i]);
    const double distance = glm::distance(truth, points.positions[i]) / step;
    const glm::dvec3 normal = -glm::normalize(testing::gradient_of(field, truth));
    const double angle = std::acos(std::min(1.0, glm::dot(normal, glm::dvec3(points.normals[i]))));
    sums.distance += distance * distance;
    sums.angle += angle * angle;
  }
  const auto count = static_cast<double>(points.size());
  return {std::sqrt(sums.distance / count), std::sqrt(sums.angle / count) * 180 / std::numbers::pi};
}

class SurfaceRowsTest : public ::testing::Test {
 protected:
  /// The points of surfaces of the file `grid_`.
  scan::ScanPoints points_of(const std::vector<IsoSurface>& surfaces, uint64_t memory = kMemory) {
    Result<SurfaceRows> rows = find_surfaces(grid_, surfaces, memory, folder_ / "model.surf");
    EXPECT_TRUE(rows) << rows.error().message;
    if (!rows) return {};
    reports_ = rows->reports;
    const Result<scan::ScanStream> stream = scan::ScanStream::of_rows(std::move(rows->rows), grid_, {});
    EXPECT_TRUE(stream) << stream.error().message;
    if (!stream) return {};
    schema_ = stream->schema();
    scan::ScanPoints points;
    for (size_t piece = 0; piece < stream->pieces(); ++piece) testing::append_points(points, *stream->read(piece));
    return points;
  }
  scan::ScanPoints points_of(double value) { return points_of(std::vector<IsoSurface>{{value}}); }

  std::string fault_at(double value, uint64_t memory = kMemory) {
    const std::vector<IsoSurface> surfaces{{value}};
    const Result<SurfaceRows> rows = find_surfaces(grid_, surfaces, memory, folder_ / "model.surf");
    return rows ? std::string() : rows.error().message;
  }

  void write(const Field& field, const std::array<int, 3>& size, const glm::dmat4x3& index_to_world) {
    testing::write_grid(grid_, field, size, index_to_world);
  }
  void write(const Field& field, int count) { write(field, {count, count, count}, unit_cube(count)); }

  model::TestFolder folder_;
  fs::path grid_ = folder_ / "grid.nrrd";
  std::vector<SurfaceReport> reports_;
  scan::ScanSchema schema_;
};

TEST_F(SurfaceRowsTest, PointsOfSmoothSurfacesAreWithinAHundredthOfAStep) {
  write(testing::soft_ball, 32);
  const Errors ball = errors_of(points_of(0.5), testing::soft_ball, 0.5, 2.0 / 31);
  EXPECT_LT(ball.distance, 0.007);
  EXPECT_LT(ball.angle, 0.6);
  write(testing::torus, 32);
  const Errors torus = errors_of(points_of(0.5), testing::torus, 0.5, 2.0 / 31);
  EXPECT_LT(torus.distance, 0.007);
  EXPECT_LT(torus.angle, 0.8);
  RecordProperty("ball", std::to_string(ball.distance) + " steps, " + std::to_string(ball.angle) + " degrees");
  RecordProperty("torus", std::to_string(torus.distance) + " steps, " + std::to_string(torus.angle) + " degrees");
}

TEST_F(SurfaceRowsTest, NoSampleOfTheFieldOfMarschnerAndLobbIsLost) {
  write(testing::marschner_lobb, 41);
  const scan::ScanPoints points = points_of(0.5);
  EXPECT_EQ(reports_[0].lost, 0U);
  const Errors errors = errors_of(points, testing::marschner_lobb, 0.5, 2.0 / 40);
  EXPECT_LT(errors.distance, 0.4);  // of the reconstruction: no field through these samples is much nearer
  RecordProperty("errors", std::to_string(errors.distance) + " steps, " + std::to_string(errors.angle) + " degrees");
}

TEST_F(SurfaceRowsTest, PointsAreSpreadEvenly) {
  write(testing::soft_ball, 32);
  const scan::ScanPoints points = points_of(0.5);
  const double step = 2.0 / 31;
  for (size_t i = 0; i < points.size(); ++i) {
    double nearest = INFINITY;
    for (size_t j = 0; j < points.size(); ++j) {
      if (i != j) nearest = std::min(nearest, glm::distance(points.positions[i], points.positions[j]));
    }
    EXPECT_GT(nearest, 0.49 * step);
    EXPECT_LT(nearest, 1.2 * step);
  }
  EXPECT_EQ(reports_[0].points, points.size());
  EXPECT_GT(reports_[0].thinned, points.size() / 5);
}

TEST_F(SurfaceRowsTest, AxesMayBeUnevenObliqueAndReversed) {
  const double step = 2.0 / 31;
  const glm::dmat4x3 uneven({step, 0, 0}, {0, step, 0}, {0, 0, 2 * step}, {-1, -1, -1});
  const glm::dmat4x3 oblique({step, 0, 0}, {0.5 * step, step, 0}, {-0.3 * step, 0.2 * step, step}, {-1.2, -1.1, -1});
  const glm::dmat4x3 reversed({-step, 0, 0}, {0, step, 0}, {0, 0, step}, {1, -1, -1});
  for (const glm::dmat4x3& axes : {uneven, oblique, reversed}) {
    write(testing::soft_ball, {36, 36, axes == uneven ? 16 : 34}, axes);
    const scan::ScanPoints points = points_of(0.5);
    EXPECT_GT(points.size(), 500U);
    const Errors errors = errors_of(points, testing::soft_ball, 0.5, step);
    EXPECT_LT(errors.distance, axes == uneven ? 0.06 : 0.012);
    EXPECT_LT(errors.angle, axes == uneven ? 3.5 : 1.2);
  }
}

TEST_F(SurfaceRowsTest, NormalsPointToWhatIsLower) {
  write([](const glm::dvec3& p) { return p.z; }, 8);
  for (const glm::vec3& normal : points_of(0.1).normals) EXPECT_NEAR(normal.z, -1, 1e-6);
  write([](const glm::dvec3& p) { return -p.z; }, 8);
  for (const glm::vec3& normal : points_of(0.1).normals) EXPECT_NEAR(normal.z, 1, 1e-6);
}

TEST_F(SurfaceRowsTest, ASurfaceReachesTheFacesOfTheGridAndEndsThere) {
  write([](const glm::dvec3& p) { return p.x + 0.5 * p.y; }, 11);
  const scan::ScanPoints points = points_of(0.05);
  geometry::Box box;
  for (const glm::dvec3& p : points.positions) box.include(p);
  for (const int axis : {1, 2}) {
    EXPECT_GE(box.min[axis], -1);
    EXPECT_LE(box.min[axis], -0.98);  // a tenth of a step
    EXPECT_GE(box.max[axis], 0.98);
    EXPECT_LE(box.max[axis], 1);
  }
}

TEST_F(SurfaceRowsTest, AValueWithoutASurfaceIsAnErrorWithTheRange) {
  write([](const glm::dvec3& p) { return p.x; }, 5);
  EXPECT_THAT(fault_at(3), HasSubstr("grid.nrrd: no surface at 3: the samples are from -1 to 1"));
  EXPECT_THAT(fault_at(-1), HasSubstr("no surface at -1: the samples are from -1 to 1"));
  write([](const glm::dvec3&) { return 7.0; }, 4);
  EXPECT_THAT(fault_at(7), HasSubstr("no surface at 7: all samples are 7"));
  write([](const glm::dvec3&) { return kNan; }, 4);
  EXPECT_THAT(fault_at(7), HasSubstr("no surface at 7: no sample is a number"));
}

TEST_F(SurfaceRowsTest, SamplesThatAreNotNumbersHaveNoSurfaceAround) {
  write([](const glm::dvec3& p) { return p.y > 0.5 ? kNan : testing::soft_ball(p); }, 32);
  const scan::ScanPoints points = points_of(0.5);
  EXPECT_GT(points.size(), 500U);
  EXPECT_GT(reports_[0].lost, 0U);
  for (const glm::dvec3& p : points.positions) EXPECT_LT(p.y, 0.5);
  EXPECT_LT(errors_of(points, testing::soft_ball, 0.5, 2.0 / 31).distance, 0.007);
}

TEST_F(SurfaceRowsTest, ALineOfSamplesHasAPointWhereItPassesTheValue) {
  write([](const glm::dvec3& p) { return std::cos(p.z); }, {1, 1, 20}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 0.5}, {3, 4, 0}});
  const scan::ScanPoints points = points_of(0.2);
  ASSERT_EQ(points.size(), 3U);
  for (const glm::dvec3& p : points.positions) {
    EXPECT_EQ(p.x, 3);
    EXPECT_EQ(p.y, 4);
    EXPECT_NEAR(std::cos(p.z), 0.2, 0.01);
  }
}

TEST_F(SurfaceRowsTest, ASampleOfTheValueItselfIsOnTheSurface) {
  write([](const glm::dvec3& p) { return p.x > 0 ? 1.0 : 0.0; }, 4);
  const scan::ScanPoints points = points_of(1);
  EXPECT_EQ(points.size(), 16U);
  for (const glm::dvec3& p : points.positions) EXPECT_NEAR(p.x, 1.0 / 3, 0.02);
}

TEST_F(SurfaceRowsTest, PointsDependNeitherOnMemoryNorOnThreads) {
  write(testing::marschner_lobb, 41);
  const std::vector<IsoSurface> surfaces{{0.5}, {0.6}};
  const scan::ScanPoints points = points_of(surfaces);
  for (const uint64_t planes : {6, 9, 14}) {
    const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, planes == 9 ? 1 : 3);
    const scan::ScanPoints again = points_of(surfaces, planes * 41 * 41 * sizeof(double));
    EXPECT_EQ(again.positions, points.positions);
    EXPECT_EQ(again.normals, points.normals);
    EXPECT_EQ(again.scalars[0].values, points.scalars[0].values);
  }
  EXPECT_THAT(fault_at(0.5, 5 * 41 * 41 * sizeof(double)), HasSubstr("a plane of its samples takes 13448 bytes"));
}

TEST_F(SurfaceRowsTest, SurfacesHaveColoursAndValues) {
  write(testing::soft_ball, 16);
  const scan::ScanPoints one = points_of(0.5);
  EXPECT_FALSE(one.colors);
  EXPECT_TRUE(one.scalars.empty());
  EXPECT_TRUE(schema_.normals);
  EXPECT_NEAR(*schema_.surface_step, 2.0 / 15, 1e-12);
  const scan::ScanPoints two = points_of({{0.5, glm::u8vec3(200, 30, 4)}, {0.25}});
  ASSERT_TRUE(two.colors);
  ASSERT_EQ(two.scalars.size(), 1U);
  EXPECT_EQ(two.scalars[0].name, "iso_value");
  const auto& values = std::get<std::vector<float>>(two.scalars[0].values);
  for (size_t i = 0; i < two.size(); ++i) {
    EXPECT_EQ(two.colors->values[i], values[i] == 0.5F ? glm::u16vec3(200, 30, 4) : glm::u16vec3(231));
  }
}

}  // namespace
}  // namespace surfcast::isosurface
