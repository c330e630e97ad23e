// Tables of points as samples of a field.

#include "scattered/read_samples.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/test_folder.h"

namespace surfcast::scattered {
namespace {

using ::testing::HasSubstr;

Result<Samples> read(const std::string& text, const FieldOptions& options, uint64_t memory = uint64_t{1} << 30) {
  const model::TestFolder folder;
  const std::filesystem::path path = folder / "points.csv";
  std::ofstream(path) << text;
  const Result<scan::ScanStream> scan = scan::ScanStream::open(path);
  if (!scan) return fail(scan);
  return read_samples(*scan, path, options, memory);
}

TEST(ReadSamplesTest, ARadiusIsTwiceTheSmoothingLength) {
  const Result<Samples> radius = read("x,y,z,v,radius\n1,2,3,4,6\n5,6,7,8,2\n", {"v"});
  ASSERT_TRUE(radius) << radius.error().message;
  EXPECT_EQ(radius->profile, Profile::kSpline);
  ASSERT_EQ(radius->kernels.size(), 2U);
  EXPECT_EQ(radius->kernels[0].centre, glm::dvec3(1, 2, 3));
  EXPECT_EQ(radius->kernels[0].value, 4);
  EXPECT_EQ(radius->kernels[0].shape.xx, 9);
  const Result<Samples> spelled = read("x,y,z,v,SmoothingLength\n1,2,3,4,3\n5,6,7,8,1\n", {"V"});
  ASSERT_TRUE(spelled) << spelled.error().message;
  EXPECT_EQ(spelled->kernels[0].shape.xx, 9);
  const Result<Samples> length = read("x,y,z,v,hsml\n1,2,3,4,3\n5,6,7,8,1\n", {"v"});
  ASSERT_TRUE(length) << length.error().message;
  EXPECT_EQ(length->kernels[0].shape.zz, 9);
}

TEST(ReadSamplesTest, SizesComeFromTheColumnThatIsStated) {
  const std::string table = "x,y,z,v,radius,s\n0,0,0,1,6,2\n1,0,0,1,6,2\n";
  EXPECT_EQ(read(table, {"v", parse_kernel_sizes("sigma=s").value()})->kernels[0].shape.xx, 4);
  EXPECT_EQ(read(table, {"v", parse_kernel_sizes("sigma=s").value()})->profile, Profile::kGaussian);
  EXPECT_EQ(read(table, {"v", parse_kernel_sizes("smoothing=0.5").value()})->kernels[1].shape.yy, 0.25);
}

TEST(ReadSamplesTest, CovariancesAreReadByTheirNames) {
  const std::string names = "x,y,z,v,cov_xx,cov_xy,cov_xz,cov_yy,cov_yz,cov_zz\n";
  const Result<Samples> samples = read(names + "0,0,0,1,4,1,0.5,3,0.25,2\n0,0,1,1,1,2,0,1,0,1\n", {"v"});
  ASSERT_TRUE(samples) << samples.error().message;
  EXPECT_EQ(samples->skipped, 1U);  // the second is no covariance
  ASSERT_EQ(samples->kernels.size(), 1U);
  const ellipsoid::SymmetricTensor& shape = samples->kernels[0].shape;
  EXPECT_EQ(shape.xy, 1);
  EXPECT_EQ(shape.xz, 0.5);
  EXPECT_EQ(shape.yz, 0.25);
  EXPECT_EQ(shape.zz, 2);
}

TEST(ReadSamplesTest, PointsWithoutAFinitePlaceValueOrSizeAreSkipped) {
  const Result<Samples> samples =
      read("x,y,z,v,h\n0,0,0,1,1\n1,0,0,nan,1\n2,0,0,1,0\n3,0,0,1,-1\nnan,0,0,1,1\n4,0,0,1,inf\n5,0,0,1,2\n", {"v"});
  ASSERT_TRUE(samples) << samples.error().message;
  EXPECT_EQ(samples->kernels.size(), 2U);
  EXPECT_EQ(samples->skipped, 5U);
  EXPECT_THAT(read("x,y,z,v,h\n0,0,0,1,0\n1,0,0,nan,1\n", {"v"}).error().message,
              HasSubstr("points.csv: no point has a finite place and value and a size above 0"));
}

TEST(ReadSamplesTest, WithoutASizeTheSpacingGivesIt) {
  std::string table = "x,y,z,v\n";
  for (int i = 0; i < 1000; ++i) {
    table += std::to_string(i % 10) + "," + std::to_string(i / 10 % 10) + "," + std::to_string(i / 100) + ",1\n";
  }
  const Result<Samples> samples = read(table, {"v"});
  ASSERT_TRUE(samples) << samples.error().message;
  // The 32nd neighbour in a cubic lattice is at distance 2.
  EXPECT_NEAR(samples->kernels[555].shape.xx, 1, 1e-9);
  EXPECT_THAT(read("x,y,z,v\n0,0,0,1\n", {"v"}).error().message, HasSubstr("points.csv: one sample alone"));
}

TEST(ReadSamplesTest, WeightsMultiplyKernels) {
  const std::string table = "x,y,z,v,h,w\n0,0,0,1,1,3\n1,0,0,1,1,0.5\n";
  FieldOptions options{"v"};
  options.weight = "w";
  const Result<Samples> samples = read(table, options);
  ASSERT_TRUE(samples) << samples.error().message;
  EXPECT_EQ(samples->kernels[0].amplitude, 3);
  EXPECT_EQ(samples->kernels[1].amplitude, 0.5);
}

TEST(ReadSamplesTest, MissingColumnsAndMemoryAreNamed) {
  const std::string table = "x,y,z,v\n0,0,0,1\n1,0,0,1\n";
  EXPECT_EQ(read(table, {"rho"}).error().message.ends_with("points.csv: has no column rho"), true);
  EXPECT_THAT(read(table, {"v", parse_kernel_sizes("radius=r").value()}).error().message,
              HasSubstr("points.csv: has no column r"));
  EXPECT_THAT(read(table, {"v", parse_kernel_sizes("covariance=c").value()}).error().message,
              HasSubstr("points.csv: has no column c_xx"));
  EXPECT_THAT(read(table, {"v"}, 100).error().message, HasSubstr("points.csv: 2 samples take "));
}

}  // namespace
}  // namespace surfcast::scattered
