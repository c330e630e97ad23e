#include "builder/input_files.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/test_folder.h"

namespace surfcast::builder {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

fs::path write(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

const std::string kNrrd = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n";
const std::string kMeta = "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = ";

std::string sog_description() {
  std::string numbers = "[0";
  for (int i = 1; i < 256; ++i) numbers += ", " + std::to_string(i);
  numbers += "]";
  return R"({"version": 2, "count": 4, "means": {"mins": [0, 0, 0], "maxs": [1, 1, 1], "files": ["l.webp", "u.webp"]},
    "scales": {"codebook": )" +
         numbers + R"(, "files": ["s.webp"]}, "quats": {"files": ["q.webp"]}, "sh0": {"codebook": )" + numbers +
         R"(, "files": ["c.webp"]}})";
}

TEST(InputFilesTest, AreTheFileAndThoseThatItNames) {
  const model::TestFolder folder;
  for (const char* name : {"a.raw", "b.raw"}) write(folder / name, "1234");
  write(folder / "all.raw", "12345678");
  const auto files = [](const fs::path& path) { return files_of_input(path).value(); };
  const fs::path attached = write(folder / "attached.nrrd", kNrrd + "\n12345678");
  EXPECT_THAT(files(attached), ElementsAre(attached));
  const fs::path list = write(folder / "list.nhdr", kNrrd + "data file: LIST\na.raw\nb.raw\n");
  EXPECT_THAT(files(list), ElementsAre(list, folder / "a.raw", folder / "b.raw"));
  EXPECT_EQ(bytes_of_input(list), fs::file_size(list) + 8);
  const fs::path meta = write(folder / "meta.mhd", kMeta + "all.raw\n");
  EXPECT_THAT(files(meta), ElementsAre(meta, folder / "all.raw"));
  const fs::path scan = write(folder / "scan.xyz", "1 2 3\n");
  EXPECT_THAT(files(scan), ElementsAre(scan));
}

TEST(InputFilesTest, OfAnAsciiGridAreItsOwnAndThatOfItsCoordinateSystem) {
  const model::TestFolder folder;
  const fs::path grid = write(folder / "dem.asc", "ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n5\n");
  EXPECT_THAT(files_of_input(grid).value(), ElementsAre(grid));
  const fs::path system = write(folder / "dem.prj", "LOCAL_CS[\"site\"]");
  EXPECT_THAT(files_of_input(grid).value(), ElementsAre(grid, system));
  const fs::path points = write(folder / "points.asc", "1 2 3\n");
  write(folder / "points.prj", "LOCAL_CS[\"site\"]");
  EXPECT_THAT(files_of_input(points).value(), ElementsAre(points));
}

TEST(InputFilesTest, OfAFolderWithASogModelAreItsDescriptionAndItsPictures) {
  const model::TestFolder folder;
  const fs::path sog = folder / "robot";
  fs::create_directories(sog);
  write(sog / "meta.json", sog_description());
  EXPECT_EQ(kind_of_input(sog), InputKind::kGaussians);
  EXPECT_THAT(files_of_input(sog).value(), ElementsAre(sog / "meta.json", sog / "l.webp", sog / "u.webp",
                                                       sog / "q.webp", sog / "s.webp", sog / "c.webp"));
  EXPECT_TRUE(check_input(sog));
}

TEST(InputFilesTest, OfVtkMayBeScansGridsOrEllipsoids) {
  const model::TestFolder folder;
  const std::string head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET ";
  const std::string points = head + "POLYDATA\nPOINTS 1 float\n1 2 3\n";
  const fs::path scan = write(folder / "scan.vtk", points);
  EXPECT_EQ(kind_of_input(scan), InputKind::kScan);
  EXPECT_TRUE(check_input(scan));
  EXPECT_THAT(files_of_input(scan).value(), ElementsAre(scan));
  const fs::path tensors = write(folder / "tensors.vtk", points + "POINT_DATA 1\nTENSORS t float\n1 0 0 0 2 0 0 0 3\n");
  EXPECT_EQ(kind_of_input(tensors), InputKind::kEllipsoids);
  EXPECT_TRUE(check_input(tensors));
  EXPECT_THAT(files_of_input(tensors).value(), ElementsAre(tensors));
  const fs::path image = write(folder / "image.vtk", head +
                                                         "STRUCTURED_POINTS\nDIMENSIONS 1 1 1\nPOINT_DATA 1\n"
                                                         "SCALARS s float\nLOOKUP_TABLE default\n1\n");
  EXPECT_EQ(kind_of_input(image), InputKind::kGrid);
  const fs::path empty = write(folder / "empty.vtp", "<VTKFile type=\"PolyData\"><PolyData/></VTKFile>");
  EXPECT_EQ(kind_of_input(empty), InputKind::kScan);
  EXPECT_THAT(check_input(empty).error().message, HasSubstr("empty.vtp: VTK: the data set has no points"));
  EXPECT_THAT(input_extensions(), ::testing::IsSupersetOf({".vtk", ".vtp", ".vtu", ".vts"}));
}

TEST(InputFilesTest, AreAllThereBeforeAGridIsTaken) {
  const model::TestFolder folder;
  const fs::path meta = write(folder / "meta.mhd", kMeta + "missing.raw\n");
  EXPECT_THAT(check_input(meta).error().message, HasSubstr("missing.raw"));
  EXPECT_THAT(files_of_input(meta).error().message, HasSubstr("missing.raw"));
  EXPECT_EQ(bytes_of_input(meta), 0U);
  write(folder / "missing.raw", "12345678");
  EXPECT_TRUE(check_input(meta));
}

}  // namespace
}  // namespace surfcast::builder
