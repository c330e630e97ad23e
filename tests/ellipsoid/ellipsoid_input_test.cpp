#include "ellipsoid/ellipsoid_input.h"

#include <array>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ellipsoid/tensor.h"
#include "grid/grid_files.h"
#include "model/test_folder.h"

namespace surfcast::ellipsoid {
namespace {

using ::testing::HasSubstr;

/// A tensor without symmetries: each order of its components gives another one.
constexpr SymmetricTensor kTensor{9, 1, 2, 7, 0.5, 4};

class EllipsoidInputTest : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& content) {
    std::ofstream(folder_ / name.c_str(), std::ios::binary) << content;
    return folder_ / name.c_str();
  }

  static std::string floats(const std::vector<float>& values) { return testing::packed_numbers(values); }

  /// All ellipsoids of a file.
  Ellipsoids read(const std::filesystem::path& path, const InputOptions& options = {}) {
    EXPECT_TRUE(holds_ellipsoids(path, options)) << path;
    Result<InputPtr> input = open_ellipsoids(path, options);
    EXPECT_TRUE(input) << (input ? "" : input.error().message);
    if (!input) return {};
    source_ = (*input)->facts();
    counts_ = {};
    Ellipsoids all;
    while (!(*input)->at_end()) {
      Result<Ellipsoids> run = (*input)->read(counts_);
      EXPECT_TRUE(run) << (run ? "" : run.error().message);
      if (!run) return all;
      all.positions.insert(all.positions.end(), run->positions.begin(), run->positions.end());
      all.values.insert(all.values.end(), run->values.begin(), run->values.end());
      all.rotations.insert(all.rotations.end(), run->rotations.begin(), run->rotations.end());
      all.samples.insert(all.samples.end(), run->samples.begin(), run->samples.end());
      all.colors.insert(all.colors.end(), run->colors.begin(), run->colors.end());
      all.scalars = run->scalars;
    }
    return all;
  }

  static std::string fault(const std::filesystem::path& path, const InputOptions& options = {}) {
    const Result<InputPtr> input = open_ellipsoids(path, options);
    return input ? "" : input.error().message;
  }

  static void expect_tensor(const Ellipsoids& all, size_t i, const SymmetricTensor& wanted) {
    ASSERT_LT(i, all.size());
    const SymmetricTensor got = tensor_of(all.values[i], glm::mat3_cast(all.rotations[i]));
    for (const auto& [a, b] : {std::pair{got.xx, wanted.xx},
                               {got.xy, wanted.xy},
                               {got.xz, wanted.xz},
                               {got.yy, wanted.yy},
                               {got.yz, wanted.yz},
                               {got.zz, wanted.zz}}) {
      EXPECT_NEAR(a, b, 1e-6);
    }
  }

  model::TestFolder folder_;
  model::EllipsoidSource source_;
  model::EllipsoidCounts counts_;
};

TEST_F(EllipsoidInputTest, NrrdHasConfidencesAndAMeasurementFrameInColumns) {
  const std::string header =
      "NRRD0005\ntype: float\ndimension: 4\nsizes: 7 2 2 1\nspace: right-anterior-superior\n"
      "space directions: none (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)\n"
      "kinds: 3D-masked-symmetric-matrix space space space\nmeasurement frame: (0,0,1) (1,0,0) (0,1,0)\n"
      "encoding: raw\nendian: little\n\n";
  std::string samples = floats({1, 9, 1, 2, 7, 0.5F, 4});
  samples += floats({0.25F, 9, 1, 2, 7, 0.5F, 4});
  samples += floats({1, NAN, 1, 2, 7, 0.5F, 4});
  samples += floats({0.5F, 9, 1, 2, -7, 0.5F, 4});
  const Ellipsoids all = read(write("t.nrrd", header + samples));
  EXPECT_EQ(counts_.samples, 4);
  EXPECT_EQ(counts_.drawn, 1);
  EXPECT_EQ(counts_.masked, 1);
  EXPECT_EQ(counts_.not_finite, 1);
  EXPECT_EQ(counts_.not_positive, 1);
  ASSERT_EQ(all.size(), 1);
  EXPECT_EQ(all.positions[0], glm::dvec3(10, 20, 30));
  // x of the frame is the world's z, y its x, z its y.
  expect_tensor(all, 0, {7, 0.5, 1, 4, 2, 9});
  EXPECT_EQ(source_.attributes[3].name, "confidence");
  EXPECT_EQ(source_.frame, model::WorldFrame::kRas);
  EXPECT_EQ(source_.least_step(), 2);
}

TEST_F(EllipsoidInputTest, SamplesAreWhereTheirIndicesAre) {
  std::string samples;
  for (int i = 0; i < 24; ++i) samples += floats({9, 1, 2, 7, 0.5F, 4});
  const Ellipsoids all = read(write("t.nrrd",
                                    "NRRD0005\ntype: float\ndimension: 4\nsizes: 6 2 3 4\nspace dimension: 3\n"
                                    "space directions: none (2,1,0) (0,3,0) (0,0,-4)\nspace origin: (1,1,1)\n"
                                    "kinds: 3D-symmetric-matrix space space space\nencoding: raw\nendian: little\n\n" +
                                        samples));
  ASSERT_EQ(all.size(), 24);
  EXPECT_EQ(all.samples[23], glm::u32vec3(1, 2, 3));
  EXPECT_EQ(all.positions[23], glm::dvec3(3, 8, -11));
  expect_tensor(all, 23, kTensor);
}

TEST_F(EllipsoidInputTest, APreviewTakesEveryFewSamples) {
  std::string samples;
  for (int i = 0; i < 512; ++i) samples += floats({9, 1, 2, 7, 0.5F, 4});
  InputOptions options;
  options.sample = 64;
  const Ellipsoids all =
      read(write("t.nrrd",
                 "NRRD0005\ntype: float\ndimension: 4\nsizes: 6 8 8 8\nkinds: 3D-symmetric-matrix space "
                 "space space\nencoding: raw\nendian: little\n\n" +
                     samples),
           options);
  EXPECT_EQ(all.size(), 64);
  EXPECT_EQ(source_.size, glm::u32vec3(4));
  EXPECT_EQ(all.positions[63], glm::dvec3(6));
  EXPECT_EQ(all.samples[63], glm::u32vec3(3));
}

std::string vtk(const std::string& body) {
  return "# vtk DataFile Version 3.0\ntitle\nASCII\n" + body;
}

TEST_F(EllipsoidInputTest, VtkImagesHaveNineNumbersOrSix) {
  const std::string grid = "DATASET STRUCTURED_POINTS\nDIMENSIONS 1 1 2\nORIGIN 0 0 5\nSPACING 1 1 2\nPOINT_DATA 2\n";
  const Ellipsoids nine =
      read(write("nine.vtk", vtk(grid + "TENSORS t float\n9 1 2 1 7 .5 2 .5 4\n9 1 2 1 7 .5 2 .5 4\n")));
  expect_tensor(nine, 1, kTensor);
  EXPECT_EQ(nine.positions[1], glm::dvec3(0, 0, 7));
  const Ellipsoids six = read(write("six.vtk", vtk(grid + "TENSORS6 t float\n9 7 4 1 .5 2\n9 7 4 1 .5 2\n")));
  expect_tensor(six, 1, kTensor);
}

TEST_F(EllipsoidInputTest, VtkPointsOfTheirOwnMayHaveTensors) {
  const Ellipsoids all = read(
      write("points.vtk",
            vtk("DATASET UNSTRUCTURED_GRID\nPOINTS 3 double\n0 0 0 1 2 3 4 5 6\nCELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n"
                "CELL_DATA 1\nSCALARS s int 1\nLOOKUP_TABLE default\n5\nPOINT_DATA 3\nSCALARS s float 1\nLOOKUP_TABLE "
                "default\n1 2 3\nTENSORS t float\n9 1 2 1 7 .5 2 .5 4\n-1 0 0 0 1 0 0 0 1\n9 1 2 1 7 .5 2 .5 4\n")));
  EXPECT_EQ(counts_.samples, 3);
  EXPECT_EQ(counts_.not_positive, 1);
  ASSERT_EQ(all.size(), 2);
  EXPECT_EQ(all.positions[1], glm::dvec3(4, 5, 6));
  expect_tensor(all, 1, kTensor);
  EXPECT_FALSE(source_.on_grid());
}

TEST_F(EllipsoidInputTest, VtkPointsMayBeBinary) {
  std::string file = "# vtk DataFile Version 5.1\ntitle\nBINARY\nDATASET POLYDATA\nPOINTS 1 float\n" +
                     testing::packed_numbers(std::vector<float>{1, 2, 3}, true) +
                     "\nVERTICES 2 1\nOFFSETS vtktypeint64\n" +
                     testing::packed_numbers(std::vector<int64_t>{0, 1}, true) + "\nCONNECTIVITY vtktypeint64\n" +
                     testing::packed_numbers(std::vector<int64_t>{0}, true) + "\nPOINT_DATA 1\nTENSORS6 t double\n" +
                     testing::packed_numbers(std::vector<double>{9, 7, 4, 1, 0.5, 2}, true) + "\n";
  const Ellipsoids all = read(write("points.vtk", file));
  ASSERT_EQ(all.size(), 1);
  EXPECT_EQ(all.positions[0], glm::dvec3(1, 2, 3));
  expect_tensor(all, 0, kTensor);
  EXPECT_THAT(fault(write("cut.vtk", file.substr(0, file.size() - 9))), HasSubstr("truncated"));
}

TEST_F(EllipsoidInputTest, VtkPointsWithoutTensorsAreNoneAndNamedIfAskedFor) {
  const auto path = write("points.vtk", vtk("DATASET POLYDATA\nPOINTS 1 float\n0 0 0\n"));
  EXPECT_FALSE(holds_ellipsoids(path));
  EXPECT_THAT(fault(path), HasSubstr("its points have no tensors"));
}

class NiftiTensorTest : public EllipsoidInputTest {
 protected:
  std::filesystem::path nifti(int16_t intent, std::vector<int64_t> sizes, const std::vector<float>& components) {
    testing::NiftiSettings settings;
    settings.type = 16;
    settings.intent = intent;
    settings.sizes = std::move(sizes);
    settings.sform = 1;
    settings.rows = {2, 0, 0, 5, 0, 2, 0, 6, 0, 0, 2, 7};
    return write("t.nii", testing::nifti_header(settings) + floats(components));
  }
};

TEST_F(NiftiTensorTest, WithItsIntentIsTheLowerTriangle) {
  const Ellipsoids all = read(nifti(1005, {1, 1, 1, 1, 6}, {9, 1, 7, 2, 0.5, 4}));
  expect_tensor(all, 0, kTensor);
  EXPECT_EQ(all.positions[0], glm::dvec3(5, 6, 7));
}

TEST_F(NiftiTensorTest, WithoutItIsAskedForItsOrder) {
  const auto path = nifti(0, {1, 1, 1, 6}, {9, 1, 2, 7, 0.5, 4});
  EXPECT_FALSE(holds_ellipsoids(path));
  EXPECT_THAT(fault(path), HasSubstr("--tensor-order"));
  InputOptions options;
  options.order = grid::TensorOrder::kFsl;
  // The axes of the grid are right-handed: x is turned, which changes the signs of xy and xz.
  expect_tensor(read(path, options), 0, {9, -1, -2, 7, 0.5, 4});
}

TEST_F(NiftiTensorTest, TakesTheOrdersOfOthers) {
  InputOptions options;
  options.order = grid::TensorOrder::kMrtrix;
  expect_tensor(read(nifti(0, {1, 1, 1, 6}, {9, 7, 4, 1, 2, 0.5}), options), 0, kTensor);
  options.order = grid::TensorOrder::kLower;
  expect_tensor(read(nifti(0, {1, 1, 1, 1, 6}, {9, 1, 7, 2, 0.5, 4}), options), 0, kTensor);
}

TEST_F(EllipsoidInputTest, MrtrixHasAxesInAnyOrder) {
  const std::string header =
      "mrtrix image\ndim: 2,1,3,6\nvox: 2,3,4,1\nlayout: -1,+0,+2,+3\ndatatype: Float32LE\n"
      "transform: 1,0,0,10\ntransform: 0,1,0,20\ntransform: 0,0,1,30\nfile: . 256\nEND\n";
  std::vector<float> samples;
  for (const float component : {9.0F, 7.0F, 4.0F, 1.0F, 2.0F, 0.5F}) samples.insert(samples.end(), 6, component);
  std::string file = header;
  file.resize(256);
  const Ellipsoids all = read(write("t.mif", file + floats(samples)));
  ASSERT_EQ(all.size(), 6);
  for (size_t i = 0; i < 6; ++i) expect_tensor(all, i, kTensor);
  EXPECT_EQ(all.positions[0], glm::dvec3(12, 20, 30)) << "x is stored from its end";
  EXPECT_EQ(all.positions[1], glm::dvec3(10, 20, 30));
  EXPECT_EQ(all.positions[5], glm::dvec3(10, 20, 38));
}

TEST_F(EllipsoidInputTest, MrtrixMayHaveTheComponentsFirstAndDataBeside) {
  write("t.dat", floats({9, 7, 4, 1, 2, 0.5, 9, 7, 4, 1, 2, 0.5}));
  const std::string header = "mrtrix image\ndim: 2,1,1,6\nvox: 2,3,4,1\nlayout: 1,2,3,0\ndatatype: Float32LE\n";
  const auto path = write("t.mih", header + "file: t.dat 0\nEND\n");
  const Ellipsoids all = read(path);
  ASSERT_EQ(all.size(), 2);
  expect_tensor(all, 1, kTensor);
  EXPECT_THAT(fault(write("out.mih", header + "file: ../t.dat 0\nEND\n")), HasSubstr("out.mih"));
  EXPECT_THAT(fault(write("cut.mif", header)), HasSubstr("truncated"));
  EXPECT_THAT(fault(write("wrong.mif",
                          "mrtrix image\ndim: 2,1,1,6\nvox: 2,3,4,1\nlayout: 1,1,3,0\ndatatype: "
                          "Float32LE\nfile: . 256\nEND\n")),
              HasSubstr("layout"));
}

TEST_F(EllipsoidInputTest, ATableHasSemiAxesRotationsColoursAndColumns) {
  const Ellipsoids all = read(write("t.csv",
                                    "x,y,z,a,b,c,qw,qx,qy,qz,red,green,blue,score\n"
                                    "1,2,3,1,3,2,0.70710678118654752,0,0,0.70710678118654752,255,128,0,0.5\n"
                                    "4,5,6,1,0,0,1,0,0,0,1,2,3,-0.25\n"
                                    "7,8,9,0,0,0,1,0,0,0,1,2,3,1\n"
                                    "7,8,9,1,1,-1,1,0,0,0,1,2,3,1\n"));
  EXPECT_EQ(counts_.samples, 4);
  EXPECT_EQ(counts_.not_positive, 2);
  ASSERT_EQ(all.size(), 2);
  EXPECT_FALSE(source_.tensors);
  EXPECT_EQ(all.positions[0], glm::dvec3(1, 2, 3));
  EXPECT_EQ(all.values[0], glm::dvec3(3, 2, 1));
  // Turned by 90 degrees about z: the second axis, of length 3, points to -x.
  const glm::dmat3 axes = glm::mat3_cast(all.rotations[0]);
  EXPECT_NEAR(std::abs(axes[0].x), 1, 1e-12);
  EXPECT_NEAR(std::abs(axes[1].z), 1, 1e-12);
  EXPECT_NEAR(glm::determinant(axes), 1, 1e-12);
  EXPECT_EQ(all.colors[0], glm::u8vec3(255, 128, 0));
  EXPECT_EQ(source_.attributes[3].name, "score");
  EXPECT_EQ(source_.attributes.size(), 4);
}

TEST_F(EllipsoidInputTest, ATableMayBePlyWithAMatrixOrATensor) {
  const std::string axes =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\n"
      "property float radius_x\nproperty float radius_y\nproperty float radius_z\n";
  std::string matrix;
  for (const char* name : {"r00", "r01", "r02", "r10", "r11", "r12", "r20", "r21", "r22"}) {
    matrix += std::string("property float ") + name + "\n";
  }
  const Ellipsoids turned = read(write("m.ply", axes + matrix + "end_header\n1 2 3 3 2 1 0 -1 0 1 0 0 0 0 1\n"));
  ASSERT_EQ(turned.size(), 1);
  EXPECT_NEAR(std::abs(glm::mat3_cast(turned.rotations[0])[0].y), 1, 1e-6) << "the first column of the matrix";
  const Ellipsoids tensor = read(write("t.csv", "x,y,z,xx,xy,xz,yy,yz,zz\n0,0,0,9,1,2,7,0.5,4\n"));
  expect_tensor(tensor, 0, kTensor);
  EXPECT_TRUE(source_.tensors);
}

TEST_F(EllipsoidInputTest, SemiAxesAloneAreEllipsoidsIfAskedFor) {
  const auto path = write("t.csv", "x,y,z,a,b,c\n0,0,0,3,2,1\n");
  EXPECT_FALSE(holds_ellipsoids(path));
  InputOptions options;
  options.asked = true;
  const Ellipsoids all = read(path, options);
  ASSERT_EQ(all.size(), 1);
  EXPECT_EQ(all.rotations[0], glm::dquat(1, 0, 0, 0));
}

TEST_F(EllipsoidInputTest, OtherFilesAreNone) {
  EXPECT_FALSE(holds_ellipsoids(write("scan.csv", "x,y,z,r,g,b\n0,0,0,1,2,3\n")));
  EXPECT_FALSE(holds_ellipsoids(write("scan.xyz", "0 0 0 1 2 3\n")));
  EXPECT_FALSE(holds_ellipsoids(folder_ / "missing"));
  EXPECT_FALSE(holds_ellipsoids(
      write("scalar.vtk", vtk("DATASET STRUCTURED_POINTS\nDIMENSIONS 1 1 1\nPOINT_DATA 1\nSCALARS s float\n1\n"))));
  EXPECT_THAT(fault(write("scan.csv", "x,y,z,r,g,b\n0,0,0,1,2,3\n")), HasSubstr("no columns of semi-axes"));
}

}  // namespace
}  // namespace surfcast::ellipsoid
