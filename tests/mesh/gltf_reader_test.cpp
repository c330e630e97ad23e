#include <cstring>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>

#include "mesh/mesh_files.h"

namespace surfcast::mesh {
namespace {

using Json = nlohmann::json;

template <typename T>
void put(std::string& bytes, std::initializer_list<T> values) {
  for (const T value : values) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k)
      bits = (bits << 8) | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0U);
    for (int k = 0; k < 4; ++k) text += kDigits[(bits >> (18 - 6 * k)) & 63U];
  }
  return text;
}

/// A triangle with quantised texture coordinates, one node.
struct Triangle3 {
  std::string bytes;
  Json json;

  Triangle3() {
    put<float>(bytes, {0, 0, 0, 2, 0, 0, 0, 2, 0});
    put<uint16_t>(bytes, {0, 0, 65535, 0, 0, 65535});
    put<uint16_t>(bytes, {0, 1, 2, 0});
    json = {{"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", {0}}}}},
            {"nodes", {{{"mesh", 0}}}},
            {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}, {"indices", 2}}}}}}},
            {"accessors",
             {{{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}},
              {{"bufferView", 1}, {"componentType", 5123}, {"count", 3}, {"type", "VEC2"}, {"normalized", true}},
              {{"bufferView", 2}, {"componentType", 5123}, {"count", 3}, {"type", "SCALAR"}}}},
            {"bufferViews",
             {{{"buffer", 0}, {"byteLength", 36}},
              {{"buffer", 0}, {"byteOffset", 36}, {"byteLength", 12}},
              {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 8}}}}};
  }

  [[nodiscard]] std::string text() const {
    Json whole = json;
    whole["buffers"] = {
        {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
    return whole.dump();
  }

  [[nodiscard]] std::string binary() const {
    Json whole = json;
    whole["buffers"] = {{{"byteLength", bytes.size()}}};
    std::string text = whole.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string file = "glTF";
    const auto words = [&file](std::initializer_list<size_t> values) {
      for (const size_t value : values) put<uint32_t>(file, {static_cast<uint32_t>(value)});
    };
    words({2, 12 + 8 + text.size() + 8 + bytes.size(), text.size(), 0x4E4F534A});
    file += text;
    words({bytes.size(), 0x004E4942});
    return file + bytes;
  }
};

const Vertices& vertices_of(const Mesh& mesh) {
  return *mesh.patches.at(0).vertices;
}

TEST(GltfReader, TextAndBinaryAreTheSameMesh) {
  const MeshFolder folder;
  const Triangle3 made;
  for (const auto& file : {folder.write("a.gltf", made.text()), folder.write("a.glb", made.binary())}) {
    const Result<Mesh> mesh = read(file);
    ASSERT_TRUE(mesh) << mesh.error().message;
    ASSERT_EQ(mesh->triangles(), 1U);
    EXPECT_EQ(vertices_of(*mesh).positions[1], glm::dvec3(2, 0, 0));
    EXPECT_EQ(vertices_of(*mesh).uvs[2], glm::dvec2(0, 1));
  }
}

TEST(GltfReader, MatricesMultiplyDownTheSceneAndEveryInstanceIsThere) {
  const MeshFolder folder;
  Triangle3 made;
  made.json["nodes"] = {{{"translation", {1e6, 0, 0}}, {"children", {1, 2}}},
                        {{"mesh", 0}, {"scale", {2, 2, 2}}},
                        {{"mesh", 0}, {"rotation", {0, 0, 1, 0}}}};  // half a turn about z
  const Result<Mesh> mesh = read(folder.write("a.gltf", made.text()));
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->patches.size(), 2U);
  const geometry::Box box = mesh->bounds();
  EXPECT_NEAR(box.max.x, 1e6 + 4, 1e-6);
  EXPECT_NEAR(box.min.x, 1e6 - 2, 1e-6);
}

TEST(GltfReader, AMirroredInstanceKeepsItsFront) {
  const MeshFolder folder;
  Triangle3 made;
  made.json["nodes"] = {{{"mesh", 0}, {"scale", {-1, 1, 1}}}};
  for (const MeshSurfel& surfel : sample(folder.write("a.gltf", made.text()), {0.1}).surfels) {
    EXPECT_EQ(surfel.normal, glm::vec3(0, 0, 1));
  }
}

TEST(GltfReader, MaterialsWithoutTwoSidesAreCulled) {
  const MeshFolder folder;
  Triangle3 made;
  EXPECT_FALSE(sample(folder.write("a.gltf", made.text()), {0.1}).report.two_sided);
  made.json["materials"] = {{{"doubleSided", true}}};
  made.json["meshes"][0]["primitives"][0]["material"] = 0;
  EXPECT_TRUE(sample(folder.write("b.gltf", made.text()), {0.1}).report.two_sided);
}

/// The triangle with an image of 4 by 4 texels in a data URI.
Triangle3 textured(const Json& info, const std::function<Texel(int, int)>& texel, const MeshFolder& folder) {
  Triangle3 made;
  folder.write("the image.tga", targa(4, 4, texel));
  made.json["images"] = {{{"uri", "the%20image.tga"}}};
  made.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  made.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
  made.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", info}}}}};
  made.json["meshes"][0]["primitives"][0]["material"] = 0;
  return made;
}

TEST(GltfReader, VCountsFromTheUpperEdge) {
  const MeshFolder folder;
  const auto texel = [](int x, int y) {
    return Texel{static_cast<uint8_t>(x * 60), static_cast<uint8_t>(y * 60), 0, 255};
  };
  const Triangle3 made = textured({{"index", 0}}, texel, folder);
  const Result<Mesh> mesh = read(folder.write("a.gltf", made.text()));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->materials[0].wrap[0], Wrap::kClamp);
  EXPECT_EQ(mesh->materials[0].wrap[1], Wrap::kMirror);
  for (const MeshSurfel& surfel : sample(*mesh).surfels) {
    EXPECT_EQ(surfel.color.r, static_cast<int>(surfel.position.x * 2) * 60);
    EXPECT_EQ(surfel.color.g, static_cast<int>(surfel.position.y * 2) * 60);
  }
}

TEST(GltfReader, TextureTransformsAndFactorsApply) {
  const MeshFolder folder;
  const auto white = [](int, int) { return Texel{255, 255, 255, 255}; };
  const Json transform = {{"offset", {0.5, 0.25}}, {"scale", {2, 1}}, {"rotation", 1.5707963267948966}};
  Triangle3 made = textured({{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}, white, folder);
  made.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 1, 0, 1};
  const Result<Mesh> mesh = read(folder.write("a.gltf", made.text()));
  ASSERT_TRUE(mesh) << mesh.error().message;
  const glm::dvec2 right = vertices_of(*mesh).uvs[1];  // (1, 0), which counter-clockwise with v down is (0, -2)
  EXPECT_NEAR(right.x, 0.5, 1e-9);
  EXPECT_NEAR(right.y, -1.75, 1e-9);
  for (const MeshSurfel& surfel : sample(*mesh).surfels) EXPECT_EQ(surfel.color, glm::u8vec3(188, 255, 0));
}

TEST(GltfReader, AlphaModesMaskBlendOrIgnoreAlpha) {
  const MeshFolder folder;
  const auto texel = [](int x, int) { return Texel{255, 0, 0, static_cast<uint8_t>(x < 2 ? 102 : 204)}; };
  Triangle3 made = textured({{"index", 0}}, texel, folder);
  const Sampled opaque = sample(folder.write("a.gltf", made.text()));
  made.json["materials"][0]["alphaMode"] = "MASK";
  const Sampled mask = sample(folder.write("b.gltf", made.text()));
  made.json["materials"][0]["alphaMode"] = "BLEND";
  const Sampled blend = sample(folder.write("c.gltf", made.text()));
  EXPECT_EQ(opaque.report.masked, 0U);
  EXPECT_FALSE(opaque.report.blended);
  EXPECT_GT(mask.report.masked, 0U);
  EXPECT_EQ(mask.surfels.size() + mask.report.masked, opaque.surfels.size());
  for (const MeshSurfel& surfel : mask.surfels) EXPECT_GT(surfel.position.x, 1);
  ASSERT_EQ(blend.surfels.size(), opaque.surfels.size());
  for (const MeshSurfel& surfel : blend.surfels) EXPECT_EQ(surfel.alpha, surfel.position.x < 1 ? 102 : 204);
}

TEST(GltfReader, SparseAccessorsReplaceValues) {
  const MeshFolder folder;
  Triangle3 made;
  const size_t indices = made.bytes.size();
  put<uint16_t>(made.bytes, {1, 0});
  put<float>(made.bytes, {5, 0, 0});
  made.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", indices}, {"byteLength", 4}});
  made.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", indices + 4}, {"byteLength", 12}});
  made.json["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", 3}, {"componentType", 5123}}}, {"values", {{"bufferView", 4}}}};
  const Result<Mesh> mesh = read(folder.write("a.gltf", made.text()));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(vertices_of(*mesh).positions[1], glm::dvec3(5, 0, 0));
}

/// The triangle's positions and texture coordinates, coded by Draco.
std::string draco_triangle() {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(1);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  const std::array<std::array<float, 3>, 3> p{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}};
  const std::array<std::array<float, 2>, 3> t{{{0, 0}, {1, 0}, {0, 1}}};
  const draco::FaceIndex face(0);
  builder.SetAttributeValuesForFace(position, face, p[0].data(), p[1].data(), p[2].data());
  builder.SetAttributeValuesForFace(uv, face, t[0].data(), t[1].data(), t[2].data());
  draco::EncoderBuffer buffer;
  draco::Encoder encoder;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*builder.Finalize(), &buffer).ok());
  return {buffer.data(), buffer.size()};
}

TEST(GltfReader, PrimitivesCodedByDracoAreRead) {
  const MeshFolder folder;
  Triangle3 made;
  const std::string coded = draco_triangle();
  made.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", made.bytes.size()}, {"byteLength", coded.size()}});
  made.bytes += coded;
  Json& primitive = made.json["meshes"][0]["primitives"][0];
  primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 3},
                                                           {"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}};
  for (Json& accessor : made.json["accessors"]) accessor.erase("bufferView");
  made.json["accessors"][1].erase("normalized");
  made.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const Result<Mesh> mesh = read(folder.write("a.glb", made.binary()));
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->triangles(), 1U);
  geometry::Box box = mesh->bounds();
  EXPECT_NEAR(box.max.x, 2, 1e-3);
  EXPECT_NEAR(box.max.y, 2, 1e-3);
  for (const Corner& corner : (*mesh->patches[0].triangles)[0]) {
    const glm::dvec3 p = vertices_of(*mesh).positions[corner.position];
    EXPECT_NEAR(glm::distance(vertices_of(*mesh).uvs[corner.uv], glm::dvec2(p) / 2.0), 0, 1e-3);
  }
  for (size_t i = 0; i < coded.size(); ++i) {
    Triangle3 damaged = made;
    damaged.bytes[damaged.bytes.size() - coded.size() + i] ^= 0x7f;
    (void)read(folder.write("b.glb", damaged.binary()));
  }
}

TEST(GltfReader, RequiredExtensionsThatAreNotReadAreRefusedByName) {
  const MeshFolder folder;
  Triangle3 made;
  made.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const Result<Mesh> mesh = read(folder.write("a.gltf", made.text()));
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().kind, ErrorKind::kUnsupported);
  EXPECT_NE(mesh.error().message.find("EXT_mesh_gpu_instancing"), std::string::npos);
}

TEST(GltfReader, HostileNumbersAreErrors) {
  const MeshFolder folder;
  const auto refused = [&](const std::function<void(Json&)>& damage) {
    Triangle3 made;
    damage(made.json);
    const Result<Mesh> mesh = read(folder.write("a.gltf", made.text()));
    return !mesh;
  };
  EXPECT_TRUE(refused([](Json& j) { j["accessors"][0]["count"] = 4; }));
  EXPECT_TRUE(refused([](Json& j) { j["accessors"][0]["count"] = 1ULL << 62; }));
  EXPECT_TRUE(refused([](Json& j) { j["accessors"][0]["byteOffset"] = UINT64_MAX; }));
  EXPECT_TRUE(refused([](Json& j) { j["accessors"][0].erase("bufferView"), j["accessors"][0]["count"] = 1 << 30; }));
  EXPECT_TRUE(refused([](Json& j) { j["bufferViews"][0]["buffer"] = 7; }));
  EXPECT_TRUE(refused([](Json& j) { j["bufferViews"][0]["byteLength"] = 1000; }));
  EXPECT_TRUE(refused([](Json& j) { j["bufferViews"][0]["byteStride"] = 1ULL << 63; }));
  EXPECT_TRUE(refused([](Json& j) { j["bufferViews"][0]["byteStride"] = 4; }));
  EXPECT_TRUE(refused([](Json& j) { j["accessors"][2]["bufferView"] = 1; }));
  EXPECT_TRUE(refused([](Json& j) { j["nodes"] = {{{"children", {0}}, {"mesh", 0}}}; }));
  EXPECT_TRUE(refused([](Json& j) { j["scenes"][0]["nodes"] = {3}; }));
  EXPECT_TRUE(refused([](Json& j) { j["meshes"] = "none"; }));
  EXPECT_TRUE(refused([](Json& j) { j["asset"]["version"] = "1.0"; }));
}

TEST(GltfReader, ABufferOutsideTheFolderIsAnError) {
  const MeshFolder folder;
  const Triangle3 made;
  folder.write("data.bin", made.bytes);
  Json whole = made.json;
  whole["buffers"] = {{{"byteLength", made.bytes.size()}, {"uri", "../data.bin"}}};
  EXPECT_FALSE(read(folder.write("model/a.gltf", whole.dump())));
  whole["buffers"][0]["uri"] = "data.bin";
  EXPECT_TRUE(read(folder.write("a.gltf", whole.dump())));
}

TEST(GltfReader, EveryTruncatedFileAndEveryChangedByteIsReadOrRefused) {
  const MeshFolder folder;
  const std::string whole = Triangle3().binary();
  for (size_t i = 0; i < whole.size(); ++i) {
    (void)read(folder.write("a.glb", whole.substr(0, i)));
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x55);
    (void)read(folder.write("a.glb", changed));
  }
}

}  // namespace
}  // namespace surfcast::mesh
