#include <cstring>
#include <fstream>
#include <iterator>
#include <numeric>

#include "model/format.h"
#include "model/model_writer.h"
#include "model/round_trip.h"

namespace surfcast::model {
namespace {

EncodedBlock surfel_block(size_t count) {
  const surfel::SurfelCloud cloud = sphere_cloud(count);
  std::vector<uint32_t> members(count);
  std::iota(members.begin(), members.end(), 0);
  return encode_block(cloud, members, surfel::Grid{glm::dvec3(1e-4), glm::dvec3(0)});
}

/// A block of an unknown kind: only its entry in the tables is interpreted.
EncodedBlock foreign_block(const char* kind, uint32_t items) {
  EncodedBlock block;
  block.bytes.assign(5, std::byte{42});
  block.origin = {10, 20, 30};
  block.extent = {1, 2, 3};
  block.items = items;
  block.spacing = 0.5F;
  block.max_radius = 2;
  block.kind = kind;
  return block;
}

std::filesystem::path write_mixed(const TestFolder& folder) {
  Result<ModelWriter> writer = ModelWriter::create(folder / "mixed.surf", schema_of(sphere_cloud(1)));
  EXPECT_TRUE(writer);
  const ldc::OctreeKey root;
  EXPECT_TRUE(writer->add(surfel_block(20), root, {}));
  const uint32_t fine = *writer->add(foreign_block("blob", 7), root.child(3), {});
  EXPECT_TRUE(writer->add(foreign_block("blob", 2), root, std::vector{fine}));
  EXPECT_EQ(writer->finish()->surfels, 20U);
  return folder / "mixed.surf";
}

char version_byte(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(8);
  return static_cast<char>(file.get());
}

TEST(Kinds, AreCountedAndTheirBlocksAreReadAsTheyAre) {
  const TestFolder folder;
  const Result<ModelFile> model = ModelFile::open(write_mixed(folder));
  ASSERT_TRUE(model) << model.error().message;
  ASSERT_EQ(model->info().kinds.size(), 2U);
  EXPECT_EQ(model->info().kinds[0].kind, "surfel");
  EXPECT_EQ(model->info().kinds[0].items, 20U);
  EXPECT_EQ(model->info().kinds[1].kind, "blob");
  EXPECT_EQ(model->info().kinds[1].blocks, 2U);
  EXPECT_EQ(model->info().kinds[1].items, 7U) << "coarse blocks are no part of the source";
  EXPECT_EQ(model->info().surfels, 20U);
  EXPECT_EQ(model->info().bounds.max, glm::dvec3(11, 22, 33)) << "of all kinds";
  for (size_t b = 0; b < model->blocks().size(); ++b) {
    const Result<StoredBlock> stored = model->stored(b);
    ASSERT_TRUE(stored);
    EXPECT_EQ(stored->items, model->blocks()[b].items);
    EXPECT_EQ(model->decode(b).has_value(), model->blocks()[b].kind == 0);
    if (model->blocks()[b].kind == 0) continue;
    EXPECT_EQ(stored->bytes.size(), 5U);
    EXPECT_EQ(stored->origin, glm::i64vec3(10, 20, 30));
    EXPECT_NE(model->decode(b).error().message.find("has no surfels"), std::string::npos);
  }
}

TEST(Kinds, OnlyOtherKindsThanSurfelsNeedTheLaterVersion) {
  const TestFolder folder;
  EXPECT_EQ(version_byte(write_mixed(folder)), char{3});
  Result<ModelWriter> writer = ModelWriter::create(folder / "surfels.surf", schema_of(sphere_cloud(1)));
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->add(surfel_block(20), ldc::OctreeKey(), {}));
  ASSERT_TRUE(writer->finish());
  EXPECT_EQ(version_byte(folder / "surfels.surf"), char{2});
  EXPECT_EQ(ModelFile::open(folder / "surfels.surf")->info().kinds.size(), 1U);
}

TEST(Kinds, AModelWithoutSurfelsIsAModel) {
  const TestFolder folder;
  Result<ModelWriter> writer = ModelWriter::create(folder / "blobs.surf", {});
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->add(foreign_block("blob", 7), ldc::OctreeKey(), {}));
  ASSERT_TRUE(writer->finish());
  const Result<ModelFile> model = ModelFile::open(folder / "blobs.surf");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->info().surfels, 0U);
  EXPECT_EQ(model->info().kinds.front().kind, "blob");
}

/// Writes and rereads the tables of a mixed model after its kinds were changed.
Result<Directory> reread(const Directory& directory) {
  const std::vector<std::byte> bytes = write_directory(directory);
  ModelHeader header;
  header.version = kKindsVersion;
  header.directory_offset = kHeaderBytes;
  header.directory_checksum = checksum_of(bytes);
  return read_directory(bytes, header);
}

TEST(Kinds, WrongTablesOfThemAreRefused) {
  Directory directory;
  directory.grids = {surfel::Grid{}};
  BlockRecord block;
  block.items = 1;
  block.spacing = block.max_radius = 1;
  block.offset = kHeaderBytes;
  block.kind = 1;
  directory.blocks = {block};
  directory.kinds = {"surfel", "blob"};
  ASSERT_TRUE(reread(directory)) << reread(directory).error().message;
  EXPECT_EQ(reread(directory)->blocks[0].kind, 1);
  const std::vector<std::vector<std::string>> hostile{{}, {"blob"}, {"blob", "blob"}, {"blob", ""}};
  for (const std::vector<std::string>& kinds : hostile) {
    directory.kinds = kinds;
    ASSERT_FALSE(reread(directory)) << kinds.size();
    EXPECT_EQ(reread(directory).error().kind, ErrorKind::kInvalidInput);
  }
  directory.kinds.assign(kMaxKinds + 1, "blob");
  EXPECT_FALSE(reread(directory));
}

TEST(Kinds, ATreeIsOfOneKind) {
  const TestFolder folder;
  std::ifstream file(write_mixed(folder), std::ios::binary);
  std::vector<char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  // The last three bytes are the kinds of the blocks: the surfels, the coarse blobs, and the fine blobs below them.
  ASSERT_EQ(bytes.back(), char{1});
  bytes.back() = 0;
  const auto all = std::as_bytes(std::span(bytes));
  ModelHeader header = *read_header(all);
  header.directory_checksum = checksum_of(all.subspan(header.directory_offset));
  const std::vector<std::byte> repaired = write_header(header);
  std::memcpy(bytes.data(), repaired.data(), repaired.size());
  std::ofstream(folder / "tree.surf", std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  const Result<ModelFile> model = ModelFile::open(folder / "tree.surf");
  ASSERT_FALSE(model);
  EXPECT_NE(model.error().message.find("make no tree"), std::string::npos) << model.error().message;
}

}  // namespace
}  // namespace surfcast::model
