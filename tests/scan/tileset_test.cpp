#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/meshopt.h"
#include "scan/samples.h"
#include "scan/scan_folder_fixture.h"
#include "scan/tile_files.h"

namespace surfcast::scan {
namespace {

using Json = nlohmann::json;
using testing::draco_points;
using ::testing::ElementsAre;
using testing::GltfFile;
using ::testing::HasSubstr;
using testing::implicit_tileset;
using testing::one_point;
using testing::scalar_values;
using testing::ScanFolderTest;

/// A tileset whose root has the contents named.
std::string tileset_of(const std::vector<std::string>& names) {
  Json root = {{"refine", "ADD"}};
  for (const std::string& name : names) root["children"].push_back({{"content", {{"uri", name}}}});
  return Json{{"asset", {{"version", "1.1"}}}, {"root", root}}.dump();
}

class GltfTilesTest : public ScanFolderTest {
 protected:
  /// The points of a tileset with this content alone.
  [[nodiscard]] Result<testing::WholeScan> read_tile(const GltfFile& file) const {
    write("tileset.json", tileset_of({"a.glb"}));
    write("a.glb", file.binary());
    return read();
  }
  [[nodiscard]] std::string error_of_tile(const GltfFile& file) const {
    const Result<testing::WholeScan> points = read_tile(file);
    return points ? "" : points.error().message;
  }
};

GltfFile one_at(float x, float y, float z) {
  return GltfFile().positions({x, y, z});
}

TEST_F(GltfTilesTest, NodesThenTheVerticalAxisThenTheCentreThenTheTileMoveThePoints) {
  GltfFile file = one_at(1, 2, 3);
  file.add<float>("NORMAL", 5126, "VEC3", 1, {0, 1, 0});
  file.json["nodes"] = {{{"translation", {10, 0, 0}}, {"children", {1}}}, {{"mesh", 0}, {"scale", {1, 2, 1}}}};
  file.json["extensionsRequired"] = {"CESIUM_RTC"};
  file.json["extensions"] = {{"CESIUM_RTC", {{"center", {1e6, 2e6, 3e6}}}}};
  write("a.glb", file.binary());
  // A quarter of a turn about z, and a step along x.
  write("tileset.json", R"({"asset": {}, "root": {"transform": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 7, 0, 0, 1],
    "content": {"uri": "a.glb"}}})");
  const Result<testing::WholeScan> points = read();
  ASSERT_TRUE(points) << points.error().message;
  // (11, 4, 3) with y up is (11, -3, 4) with z up, and (1000011, 1999997, 3000004) about the centre.
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(-1999997 + 7, 1000011, 3000004)));
  EXPECT_THAT(points->normals, ElementsAre(glm::vec3(0, 0, 1)));
  EXPECT_TRUE(points->z_up);
}

TEST_F(GltfTilesTest, TilesOfB3dmHaveACentreOfTheirOwn) {
  const std::string glb = one_at(1, 2, 3).binary();
  std::string file = testing::pnts(R"({"BATCH_LENGTH": 0, "RTC_CENTER": [100, 200, 300]})", "") + glb;
  file.replace(0, 4, "b3dm");
  write("a.b3dm", file);
  write("tileset.json", tileset_of({"a.b3dm"}));
  EXPECT_THAT(read().value().positions, ElementsAre(glm::dvec3(101, 197, 302)));
}

TEST_F(GltfTilesTest, QuantisedPositionsAreScaledByTheirNode) {
  GltfFile file;
  file.add<uint16_t>("POSITION", 5123, "VEC3", 2, {0, 65535, 13107, 65535, 0, 0}, true);
  file.add<int8_t>("NORMAL", 5120, "VEC3", 2, {0, 127, 0, 0, 0, -127}, true);
  file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  file.json["nodes"][0]["scale"] = {10, 10, 10};
  file.json["nodes"][0]["translation"] = {1, 2, 3};
  const Result<testing::WholeScan> points = read_tile(file);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(1, -5, 12), glm::dvec3(11, -3, 2)));
  EXPECT_THAT(points->normals, ElementsAre(glm::vec3(0, 0, 1), glm::vec3(0, 1, 0)));
}

/// IEC 61966-2-1, by itself.
uint16_t srgb(double light, int most) {
  const double value = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
  return static_cast<uint16_t>(std::lround(value * most));
}

TEST_F(GltfTilesTest, ColoursAreLinearLight) {
  const auto color_of = [this](const GltfFile& file) { return read_tile(file).value().colors.value(); };
  const surfel::ColorAttribute bytes =
      color_of(one_at(0, 0, 0).add<uint8_t>("COLOR_0", 5121, "VEC4", 1, {255, 55, 1, 9}, true));
  EXPECT_EQ(bytes.bits, 8);
  EXPECT_EQ(bytes.values[0], glm::u16vec3(255, srgb(55 / 255.0, 255), srgb(1 / 255.0, 255)));
  const surfel::ColorAttribute words =
      color_of(one_at(0, 0, 0).add<uint16_t>("COLOR_0", 5123, "VEC3", 1, {65535, 300, 1}, true));
  EXPECT_EQ(words.bits, 16);
  EXPECT_EQ(words.values[0], glm::u16vec3(65535, srgb(300 / 65535.0, 65535), srgb(1 / 65535.0, 65535)));
  GltfFile file = one_at(0, 0, 0).add<float>("COLOR_0", 5126, "VEC3", 1, {0.5F, 2, 0.25F});
  EXPECT_EQ(color_of(file).values[0], glm::u16vec3(srgb(0.5, 65535), 65535, srgb(0.25, 65535)));
  file.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1, 1}}}}}};
  file.primitive()["material"] = 0;
  EXPECT_EQ(color_of(file).values[0], glm::u16vec3(srgb(0.25, 65535), srgb(0.5, 65535), srgb(0.25, 65535)));
}

TEST_F(GltfTilesTest, CompressedPointsKeepTheirAttributes) {
  GltfFile file = draco_points();
  const Result<testing::WholeScan> points = read_tile(file);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(0, -3, 2), glm::dvec3(1, -3, 2)));
  EXPECT_THAT(points->colors->values, ElementsAre(glm::u16vec3(0, 255, 0), glm::u16vec3(255, 255, 0)));
  EXPECT_THAT(scalar_values<uint16_t>(*points, "intensity"), ElementsAre(500, 501));
  for (Json& accessor : file.json["accessors"]) accessor["count"] = 3;
  EXPECT_THAT(error_of_tile(file), HasSubstr("has not the points that its accessors state"));
  for (Json& accessor : file.json["accessors"]) accessor["count"] = 1'000'000;
  EXPECT_THAT(error_of_tile(file), HasSubstr("more points than its buffers can hold"));
}

TEST_F(GltfTilesTest, ViewsOfMeshoptAreDecompressed) {
  GltfFile file = testing::meshopt_points();
  const Result<testing::WholeScan> points = read_tile(file);
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), testing::kPackedPoints);
  for (size_t i = 0; i < testing::kPackedPoints; ++i) {
    const auto n = static_cast<double>(i);
    EXPECT_EQ(points->positions[i], glm::dvec3(n * 217, n - 65535, i % 7)) << i;
  }
  EXPECT_EQ(points->normals[0], glm::vec3(0, -1, 0));
  EXPECT_EQ(points->normals[1], glm::vec3(-1, 0, 0));
  EXPECT_NEAR(points->normals[2].y, 1, 1e-6);
  Json& view = file.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"];
  view["filter"] = "QUATERNION";
  EXPECT_THAT(error_of_tile(file), HasSubstr("the filter QUATERNION of EXT_meshopt_compression"));
  view["mode"] = "TRIANGLES";
  EXPECT_THAT(error_of_tile(file), HasSubstr("the mode TRIANGLES of EXT_meshopt_compression"));
  view["mode"] = "ATTRIBUTES";
  view["byteLength"] = 40;
  EXPECT_THAT(error_of_tile(file), HasSubstr("damaged or truncated meshopt data"));
}

TEST(MeshoptTest, TheExampleOfItsSpecificationIsDecoded) {
  // Sixteen differences of four bits, and the baseline 100.
  std::string packed = "\xA0";
  packed += "\x02";
  packed += std::string("\x17\x5f\xf0\xbc\x77\xa9\x21\x00\x34\xb5", 10);
  for (int k = 1; k < 4; ++k) packed += '\0';
  packed += std::string(28, '\0') + "\x64" + std::string(3, '\0');
  const auto made = decode_meshopt(testing::as_bytes(packed), {16, 4, "ATTRIBUTES", ""});
  ASSERT_TRUE(made) << made.error().message;
  int value = 100;
  const int steps[] = {-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0};
  for (size_t i = 0; i < 16; ++i) {
    value += steps[i];
    EXPECT_EQ(std::to_integer<uint8_t>((*made)[4 * i]), static_cast<uint8_t>(value)) << i;
  }
}

TEST(MeshoptTest, ExponentsBecomeFloats) {
  const std::string plain = testing::Bytes().add((-1 << 24) | 3).add(int32_t{0x00FFFFFF}).text();
  const auto made =
      decode_meshopt(testing::as_bytes(testing::meshopt_attributes(plain, 4)), {2, 4, "ATTRIBUTES", "EXPONENTIAL"});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(load<float>(made->data()), 1.5F);
  EXPECT_EQ(load<float>(made->data() + 4), -1.0F);
}

TEST_F(GltfTilesTest, TilesOfBothKindsHaveTheColumnsOfAll) {
  write("tileset.json", tileset_of({"a.glb", "b.pnts", "c.glb"}));
  GltfFile first = one_at(1, 0, 0);
  first.add<uint16_t>("COLOR_0", 5123, "VEC3", 1, {65535, 0, 0}, true);
  first.add<uint8_t>("_CLASSIFICATION", 5121, "SCALAR", 1, {6});
  write("a.glb", first.binary());
  write("b.pnts", testing::pnts(R"({"POINTS_LENGTH": 1, "POSITION": {"byteOffset": 0}, "RGB": {"byteOffset": 12}})",
                                std::string(12, '\0') + "\xFF\x80\x01"));
  write("c.glb", one_at(3, 0, 0).binary());
  const Result<testing::WholeScan> points = read();
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(points->colors->bits, 16);
  EXPECT_THAT(points->colors->values,
              ElementsAre(glm::u16vec3(65535, 0, 0), glm::u16vec3(65535, 128 * 257, 257), glm::u16vec3(128 * 257)));
  EXPECT_THAT(scalar_values<uint8_t>(*points, "classification"), ElementsAre(6, 0, 0));
}

/// A tile of three points whose Draco data hold positions and batches, and nothing else.
std::string partly_draco(Json properties) {
  const std::string cloud = testing::draco_batches(3);
  const std::string beside = {'\x0A', '\x14', '\x1E', '\x28', '\x32', '\x3C', '\x46', '\x50', '\x5A', '\0', '\1', '\1'};
  const Json packed = {{"byteOffset", 0}, {"byteLength", cloud.size()}, {"properties", std::move(properties)}};
  const Json features = {{"POINTS_LENGTH", 3},
                         {"BATCH_LENGTH", 2},
                         {"POSITION", {{"byteOffset", 0}}},
                         {"RGB", {{"byteOffset", cloud.size()}}},
                         {"BATCH_ID", {{"byteOffset", cloud.size() + 9}, {"componentType", "UNSIGNED_BYTE"}}},
                         {"extensions", {{"3DTILES_draco_point_compression", packed}}}};
  return testing::pnts(features.dump(), cloud + beside,
                       R"({"height": {"byteOffset": 0, "componentType": "UNSIGNED_SHORT", "type": "SCALAR"}})",
                       std::string("\7\0\x9\0", 4));
}

TEST_F(GltfTilesTest, WhatIsBesideTheDracoDataOfATileIsRead) {
  write("tileset.json", tileset_of({"a.pnts"}));
  write("a.pnts", partly_draco({{"POSITION", 0}, {"BATCH_ID", 1}}));
  const Result<testing::WholeScan> points = read();
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(0), glm::dvec3(1, 0, 0), glm::dvec3(2, 0, 0)));
  ASSERT_TRUE(points->colors);
  EXPECT_THAT(points->colors->values,
              ElementsAre(glm::u16vec3(10, 20, 30), glm::u16vec3(40, 50, 60), glm::u16vec3(70, 80, 90)));
  EXPECT_THAT(scalar_values<uint16_t>(*points, "height"), ElementsAre(9, 7, 9));
}

TEST_F(GltfTilesTest, BatchesBesideTheDracoDataAreThoseOfTheFeatureTable) {
  write("tileset.json", tileset_of({"a.pnts"}));
  write("a.pnts", partly_draco({{"POSITION", 0}}));
  const Result<testing::WholeScan> points = read();
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(scalar_values<uint16_t>(*points, "height"), ElementsAre(7, 9, 9));
}

TEST_F(GltfTilesTest, IndicesAndInstancesMakeRows) {
  GltfFile file = GltfFile().positions({1, 0, 0, 2, 0, 0, 3, 0, 0});
  file.add<uint8_t>("unused", 5121, "SCALAR", 2, {2, 0});
  file.primitive()["indices"] = file.primitive()["attributes"]["unused"];
  file.primitive()["attributes"].erase("unused");
  file.json["scenes"][0]["nodes"] = {0, 1};
  file.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {10, 0, 0}}}};
  EXPECT_THAT(read_tile(file).value().positions,
              ElementsAre(glm::dvec3(3, 0, 0), glm::dvec3(1, 0, 0), glm::dvec3(13, 0, 0), glm::dvec3(11, 0, 0)));
}

TEST_F(GltfTilesTest, BuffersLieInTheFolderOfTheirFile) {
  const GltfFile file = one_at(1, 2, 3);
  write("sub/points.bin", file.bytes);
  write("sub/a.gltf", file.text("points.bin"));
  write("tileset.json", tileset_of({"sub/a.gltf"}));
  EXPECT_THAT(read().value().positions, ElementsAre(glm::dvec3(1, -3, 2)));
  write("points.bin", file.bytes);
  write("sub/a.gltf", file.text("../points.bin"));
  EXPECT_THAT(error(), HasSubstr("sub/a.gltf: names a buffer that is not in its folder"));
}

TEST_F(GltfTilesTest, WhatIsNoPointIsNamed) {
  GltfFile file = one_at(1, 2, 3);
  file.primitive()["mode"] = 4;
  EXPECT_THAT(error_of_tile(file), HasSubstr("tiles of meshes alone"));
  file.primitive()["mode"] = 0;
  file.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}});
  EXPECT_EQ(read_tile(file).value().size(), 1U);
  EXPECT_THAT(ScanStream::open(folder_).value().schema().notes, ElementsAre(HasSubstr("triangles")));
  file.json["extensionsRequired"] = {"EXT_secret"};
  EXPECT_THAT(error_of_tile(file), HasSubstr("a.glb: needs the glTF extension EXT_secret"));
  file = one_at(1, 2, 3);
  file.json["accessors"][0]["count"] = 13;
  EXPECT_THAT(error_of_tile(file), HasSubstr("a.glb: states more points than its buffers can hold"));
  file.json["accessors"][0]["count"] = 2;
  EXPECT_THAT(error_of_tile(file), HasSubstr("a.glb: glTF accessor beyond the end"));
}

TEST_F(GltfTilesTest, AFileAloneKeepsItsVerticalAxis) {
  write("a.glb", one_at(1, 2, 3).binary());
  const Result<testing::WholeScan> points = testing::whole(ScanStream::open(folder_ / "a.glb"));
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions, ElementsAre(glm::dvec3(1, 2, 3)));
  EXPECT_FALSE(points->z_up);
}

// ---- implicit tilings

class ImplicitTilesTest : public ScanFolderTest {
 protected:
  void write_quadtree(const std::string& refine) const {
    for (const auto& [name, text] : testing::quadtree_files(refine)) write(name, text);
  }
};

TEST_F(ImplicitTilesTest, BitStreamsSayWhichTilesOfAQuadtreeThereAre) {
  write_quadtree("ADD");
  const Result<testing::WholeScan> points = read();
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_THAT(points->positions,
              ElementsAre(glm::dvec3(0, 0, 100), glm::dvec3(1, 0, 100), glm::dvec3(2, 0, 100), glm::dvec3(3, 0, 100)));
}

TEST_F(ImplicitTilesTest, OfReplacedTilesOnlyTheDeepestAreRead) {
  write_quadtree("REPLACE");
  std::filesystem::remove(folder_ / "content/0/0/0.pnts");
  EXPECT_THAT(read().value().positions, ElementsAre(glm::dvec3(1, 0, 100), glm::dvec3(3, 0, 100)));
}

TEST_F(ImplicitTilesTest, ConstantsStandForAllTilesOfAnOctree) {
  Json tileset = implicit_tileset("OCTREE", 2, 2);
  write("tileset.json", tileset.dump());
  write("subtrees/0/0/0/0.subtree", R"({"tileAvailability": {"constant": 1}, "contentAvailability": [{"constant": 1}],
    "childSubtreeAvailability": {"constant": 1}})");
  write("content/0/0/0/0.pnts", one_point(-1));
  for (size_t i = 0; i < 8; ++i) {
    const std::string key = std::to_string(i & 1) + "/" + std::to_string(i >> 1 & 1) + "/" + std::to_string(i >> 2);
    write("content/1/" + key + ".pnts", one_point(static_cast<float>(i)));
  }
  const Result<testing::WholeScan> points = read();
  ASSERT_TRUE(points) << points.error().message;
  std::vector<double> along;
  for (const glm::dvec3& position : points->positions) along.push_back(position.x);
  EXPECT_THAT(along, ElementsAre(-1, 0, 1, 2, 3, 4, 5, 6, 7));
}

TEST_F(ImplicitTilesTest, TilesMayHaveSeveralContentsAndTilesetsAsContent) {
  Json tileset = implicit_tileset("QUADTREE", 1, 1);
  tileset["root"].erase("content");
  tileset["root"]["contents"] = {
      {{"uri", "{level}-{x}-{y}.glb"}}, {{"uri", "none-{level}-{x}-{y}.pnts"}}, {{"uri", "more/{level}-{x}-{y}.json"}}};
  write("tileset.json", tileset.dump());
  write("subtrees/0/0/0.subtree", R"({"tileAvailability": {"constant": 1}, "contentAvailability": [{"constant": 1},
    {"constant": 0}, {"constant": 1}], "childSubtreeAvailability": {"constant": 0}})");
  write("0-0-0.glb", one_at(1, 2, 3).binary());
  write("more/0-0-0.json", tileset_of({"b.pnts"}));
  write("more/b.pnts", one_point(7));
  EXPECT_THAT(read().value().positions, ElementsAre(glm::dvec3(1, -3, 2), glm::dvec3(7, 0, 0)));
}

TEST_F(ImplicitTilesTest, TheExtensionOfTilesets10IsReadToo) {
  write_quadtree("ADD");
  Json tileset = implicit_tileset("QUADTREE", 2, 3);
  Json tiling = tileset["root"]["implicitTiling"];
  tiling.erase("availableLevels");
  tiling["maximumLevel"] = 2;
  tileset["root"].erase("implicitTiling");
  tileset["root"]["extensions"]["3DTILES_implicit_tiling"] = tiling;
  write("tileset.json", tileset.dump());
  EXPECT_EQ(read().value().size(), 4U);
}

TEST_F(ImplicitTilesTest, DamagedTilingsAreNamed) {
  write_quadtree("ADD");
  const auto error_with = [this](const char* name, const Json& value) {
    Json tileset = implicit_tileset("QUADTREE", 2, 3);
    tileset["root"]["implicitTiling"][name] = value;
    write("tileset.json", tileset.dump());
    return error();
  };
  EXPECT_THAT(error_with("subdivisionScheme", "TREE"), HasSubstr("implicit tiling of the scheme TREE"));
  EXPECT_THAT(error_with("subtreeLevels", 0), HasSubstr("levels that cannot be"));
  EXPECT_THAT(error_with("subtreeLevels", 30), HasSubstr("levels that cannot be"));
  EXPECT_THAT(error_with("availableLevels", 1000), HasSubstr("levels that cannot be"));
  EXPECT_THAT(error_with("subtreeLevels", 3), HasSubstr("0.subtree: truncated: a bit stream that is shorter"));
  EXPECT_THAT(error_with("subtrees", {{"uri", "{level}-{x}"}}), HasSubstr("lacks level or coordinates"));
  EXPECT_THAT(error_with("subtrees", {{"uri", "../{level}/{x}/{y}"}}), HasSubstr("outside of its folder"));
  EXPECT_THAT(error_with("subtrees", {{"uri", "no/{level}/{x}/{y}"}}), HasSubstr("no/0/0/0"));
  write("tileset.json", implicit_tileset("QUADTREE", 2, 3).dump());
  std::filesystem::remove(folder_ / "content/1/0/1.pnts");
  EXPECT_THAT(error(), HasSubstr("1.pnts"));
  write("subtrees/0/0/0.subtree", "subt");
  EXPECT_THAT(error(), HasSubstr("truncated: the header of a subtree"));
}

}  // namespace
}  // namespace surfcast::scan
