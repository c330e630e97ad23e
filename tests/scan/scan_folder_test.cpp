#include "scan/scan_folder.h"

#include <filesystem>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/bytes.h"
#include "scan/folder_files.h"
#include "scan/scan_folder_fixture.h"
#include "scan/tile_files.h"
#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

namespace fs = std::filesystem;
using testing::bin_point;
using testing::brotli_node;
using testing::Bytes;
using testing::cloud_js;
using ::testing::ElementsAre;
using testing::ept_json;
using ::testing::HasSubstr;
using testing::hrc_entry;
using testing::metadata;
using testing::node2;
using testing::one_point;
using testing::pnts;
using testing::point2;
using testing::scalar_values;
using testing::ScanFolderTest;
using testing::tileset;
using ::testing::UnorderedElementsAre;
using testing::write_ept;
using testing::zstd_of;

geometry::Box box_of(const glm::dvec3& low, const glm::dvec3& high) {
  geometry::Box box;
  box.min = low;
  box.max = high;
  return box;
}

// ---- EPT

TEST_F(ScanFolderTest, TilesOfEptAreReadInTheOrderOfTheirKeys) {
  const auto write_file = [this](const std::string& name, const std::string& text) { write(name, text); };
  for (const bool packed : {false, true}) {
    fs::remove_all(folder_);
    if (packed) write_ept(write_file, "zstandard", ".zst", zstd_of);
    if (!packed) write_ept(write_file, "binary", ".bin", [](std::string text) { return text; });
    const Result<ScanStream> stream = ScanStream::open(folder_);
    ASSERT_TRUE(stream) << stream.error().message;
    EXPECT_EQ(stream->schema().crs, "EPSG:2154");
    const Result<testing::WholeScan> points = testing::whole(stream);
    ASSERT_TRUE(points) << points.error().message;
    EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(2, 2, 0.25), glm::dvec3(1, 7, 7), glm::dvec3(7, 1, 3)));
    EXPECT_THAT(scalar_values<uint16_t>(*points, "intensity"), ElementsAre(7, 9, 8));
  }
}

TEST_F(ScanFolderTest, TilesOfEptOutsideOfTheBoxAreNotOpened) {
  write_ept([this](const std::string& name, const std::string& text) { write(name, text); }, "binary", ".bin",
            [](std::string text) { return text; });
  fs::remove(folder_ / "ept-data/1-1-0-0.bin");
  Selection selection;
  selection.zone.boxes = {box_of({0, 0, 0}, {3, 8, 8})};
  const Result<testing::WholeScan> points = read(selection);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(2, 2, 0.25), glm::dvec3(1, 7, 7)));
  EXPECT_THAT(error(), HasSubstr("1-1-0-0.bin"));
}

TEST_F(ScanFolderTest, DamagedEptIsNamed) {
  const auto write_file = [this](const std::string& name, const std::string& text) { write(name, text); };
  write_ept(write_file, "zstandard", ".zst", zstd_of);
  write("ept-hierarchy/1-0-1-1.json", R"({"1-0-1-1": -1})");
  EXPECT_THAT(error(), HasSubstr("within itself"));
  write("ept-hierarchy/1-0-1-1.json", R"({"1-0-2-1": 1})");
  EXPECT_THAT(error(), HasSubstr("an entry that cannot be"));
  write("ept-hierarchy/1-0-1-1.json", "[");
  EXPECT_THAT(error(), HasSubstr("no JSON object"));
  write("ept-hierarchy/1-0-1-1.json", R"({"1-0-1-1": 2})");
  EXPECT_THAT(error(), HasSubstr("1-0-1-1.zst: has not the points"));
  write("ept-hierarchy/1-0-1-1.json", R"({"1-0-1-1": 1})");
  write("ept-data/1-0-1-1.zst", "noise");
  EXPECT_THAT(error(), HasSubstr("1-0-1-1.zst: is damaged"));
  write("ept.json", ept_json("quantum"));
  EXPECT_THAT(error(), HasSubstr("EPT data of type quantum"));
}

// ---- Potree

TEST_F(ScanFolderTest, Potree1WithoutAttributesIsRefused) {
  write("cloud.js", R"({"octreeDir": "data", "boundingBox": {"lx": 10, "ly": 0, "lz": 0, "ux": 18, "uy": 8, "uz": 8},
    "pointAttributes": [], "hierarchy": [["r", 1]]})");
  write("data/r.bin", "x");
  EXPECT_THAT(error(), HasSubstr("names no attributes"));
}

TEST_F(ScanFolderTest, NodesOfPotree1LieInTheirCubesAndFolders) {
  write("cloud.js", cloud_js(R"("hierarchyStepSize": 1)"));
  write("data/r/r.hrc", hrc_entry(1 << 4, 1) + hrc_entry(1 << 1, 1));
  write("data/r/4/r4.hrc", hrc_entry(1 << 1, 1) + hrc_entry(0, 1));
  write("data/r/r.bin", bin_point(1, 2, 3));
  write("data/r/4/r4.bin", bin_point(1, 2, 3));
  write("data/r/4/1/r41.bin", bin_point(1, 2, 3));
  const Result<testing::WholeScan> points = read();
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions,
              ElementsAre(glm::dvec3(10.25, 0.5, 0.75), glm::dvec3(14.25, 0.5, 0.75), glm::dvec3(14.25, 0.5, 2.75)));
  EXPECT_EQ(points->colors->values[0], glm::u16vec3(1, 2, 3));
  EXPECT_NEAR(points->normals[0].x, 1, 0.02);
}

TEST_F(ScanFolderTest, TheHierarchyOfPotree1MayStandInItsDescription) {
  write("cloud.js", cloud_js(R"("hierarchy": [["r", 1], ["r4", 1], ["r0", 0]])"));
  write("data/r.bin", bin_point(1, 2, 3));
  write("data/r4.bin", bin_point(1, 2, 3));
  EXPECT_EQ(read().value().size(), 2U);
  Selection selection;
  selection.zone.boxes = {box_of({10, 0, 0}, {11, 8, 8})};
  fs::remove(folder_ / "data/r4.bin");
  EXPECT_EQ(read(selection).value().size(), 1U);
  write("cloud.js", cloud_js(R"("hierarchy": [["r", 2]])"));
  EXPECT_THAT(error(), HasSubstr("r.bin: has not the points"));
  write("cloud.js", cloud_js(R"("hierarchy": [["../r", 2]])"));
  EXPECT_THAT(error(), HasSubstr("hierarchy is damaged"));
}

TEST_F(ScanFolderTest, BothEncodingsOfPotree2AreRead) {
  for (const bool brotli : {false, true}) {
    fs::remove_all(folder_);
    const std::string first = brotli ? brotli_node(1 << 20, 7, 400) : point2(1 << 20, 7, 400);
    const std::string second = brotli ? brotli_node(4, 8, 1) : point2(4, 8, 1);
    write("metadata.json", metadata(brotli ? "BROTLI" : "DEFAULT"));
    // The root, a link to a page of one node, and an empty node.
    write("hierarchy.bin", node2(0, 0b101, 1, 0, first.size()) + node2(2, 0, 1, 66, 22) + node2(1, 0, 9, 0, 0) +
                               node2(1, 0, 1, first.size(), second.size()));
    std::string text = metadata(brotli ? "BROTLI" : "DEFAULT");
    text.replace(text.find("44"), 2, "66");
    write("metadata.json", text);
    write("octree.bin", first + second);
    const Result<testing::WholeScan> points = read();
    ASSERT_TRUE(points) << points.error().message;
    EXPECT_THAT(points->positions, ElementsAre(glm::dvec3((1 << 19) + 10, 21, 28.5), glm::dvec3(12, 21, 28.5)));
    EXPECT_THAT(scalar_values<uint16_t>(*points, "intensity"), ElementsAre(7, 8));
    EXPECT_EQ(points->colors->values[0], glm::u16vec3(400, 300, 5));
    write("octree.bin", first);
    EXPECT_THAT(error(), HasSubstr("octree.bin: truncated: node r0"));
    write("hierarchy.bin", node2(0, 1, 1, 0, first.size()) + node2(2, 0, 1, 0, 44));
    EXPECT_NE(error(), "");
  }
}

// ---- 3D Tiles

TEST(PntsReaderTest, QuantisedPositionsAndPackedColoursAreUnpacked) {
  const std::string bytes = Bytes()
                                .add(uint16_t{65535})
                                .add(uint16_t{0})
                                .add(uint16_t{13107})
                                .add(static_cast<uint16_t>(31 << 11 | 0 << 5 | 31))
                                .add(uint8_t{255})
                                .add(uint8_t{128})
                                .text();
  const std::string file =
      pnts(R"({"POINTS_LENGTH": 1, "RTC_CENTER": [1e6, 0, 0], "POSITION_QUANTIZED": {"byteOffset": 0},
    "QUANTIZED_VOLUME_OFFSET": [1, 2, 3], "QUANTIZED_VOLUME_SCALE": [10, 10, 10], "RGB565": {"byteOffset": 6},
    "NORMAL_OCT16P": {"byteOffset": 8}})",
           bytes);
  const Result<testing::WholeScan> points = testing::read_whole(testing::as_bytes(file), "tile.pnts");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(1000011, 2, 5)));
  EXPECT_EQ(points->colors->values[0], glm::u16vec3(255, 0, 255));
  EXPECT_NEAR(points->normals[0].x, 1, 0.02);
}

TEST(PntsReaderTest, PointsHaveTheNumbersOfTheirBatch) {
  const std::string positions(24, '\0');
  const std::string file = pnts(
      R"({"POINTS_LENGTH": 2, "BATCH_LENGTH": 3, "POSITION": {"byteOffset": 0},
    "BATCH_ID": {"byteOffset": 24, "componentType": "UNSIGNED_BYTE"}})",
      positions + std::string("\2\0", 2),
      R"({"height": {"byteOffset": 0, "componentType": "UNSIGNED_SHORT", "type": "SCALAR"}, "name": ["a", "b", "c"]})",
      Bytes().add(uint16_t{10}).add(uint16_t{20}).add(uint16_t{30}).text());
  const Result<testing::WholeScan> points = testing::read_whole(testing::as_bytes(file), "tile.pnts");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(scalar_values<uint16_t>(*points, "height"), ElementsAre(30, 10));
}

TEST(PntsReaderTest, DamageIsReadOrRefused) {
  const std::string good = one_point(1);
  for (size_t size = 4; size < good.size(); ++size) {
    EXPECT_FALSE(testing::read_whole(testing::as_bytes(good.substr(0, size)), "tile.pnts")) << size;
  }
  std::mt19937 random(2);
  for (int i = 0; i < 2000; ++i) {
    std::string file = good;
    for (auto flips = 1 + random() % 3; flips > 0; --flips) {
      char& byte = file[4 + random() % (file.size() - 4)];
      byte = static_cast<char>(byte ^ 1 << random() % 8);
    }
    const Result<testing::WholeScan> points = testing::read_whole(testing::as_bytes(file), "tile.pnts");
    ASSERT_LE(points ? points->size() : 0, 100000U);
  }
}

TEST_F(ScanFolderTest, TransformsOfTilesetsMultiplyAndReplacedTilesAreLeftOut) {
  write("root.pnts", one_point(1));
  write("a.pnts", one_point(2));
  write("sub/more.json", R"({"asset": {}, "root": {"content": {"uri": "b.pnts"}}})");
  write("sub/b.pnts", one_point(3));
  write("tileset.json", tileset("ADD"));
  const Result<testing::WholeScan> all = read();
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_THAT(all->positions, ElementsAre(glm::dvec3(11, 0, 0), glm::dvec3(14, 5, 0), glm::dvec3(13, 0, 0)));
  write("tileset.json", tileset("REPLACE"));
  EXPECT_THAT(read().value().positions, ElementsAre(glm::dvec3(14, 5, 0), glm::dvec3(13, 0, 0)));
  const std::optional<ScanFolder> found = scan_folder_of(folder_);
  ASSERT_TRUE(found);
  EXPECT_THAT(files_of_folder(*found),
              UnorderedElementsAre(folder_ / "tileset.json", folder_ / "root.pnts", folder_ / "a.pnts",
                                   folder_ / "sub/more.json", folder_ / "sub/b.pnts"));
}

TEST_F(ScanFolderTest, TilesetsThatLeadAstrayAreRefused) {
  const auto with_content = [this](const std::string& uri) {
    write("tileset.json", R"({"asset": {}, "root": {"content": {"uri": ")" + uri + R"("}}})");
    return error();
  };
  write("here.pnts", one_point(1));
  write("damaged.glb", "glTF....");
  write("a.i3dm", "i3dm....");
  EXPECT_EQ(with_content("here.pnts"), "");
  EXPECT_THAT(with_content("../here.pnts"), HasSubstr("outside of its folder"));
  EXPECT_THAT(with_content("/etc/passwd"), HasSubstr("without a usable name"));
  EXPECT_THAT(with_content("http://example.org/a.pnts"), HasSubstr("outside of its folder"));
  EXPECT_THAT(with_content("tileset.json"), HasSubstr("nested too deeply"));
  EXPECT_THAT(with_content("damaged.glb"), HasSubstr("damaged.glb: truncated: GLB header"));
  EXPECT_THAT(with_content("a.i3dm"), HasSubstr("a tile of kind i3dm is not supported"));
}

}  // namespace
}  // namespace surfcast::scan
