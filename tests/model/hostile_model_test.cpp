#include <cstring>
#include <random>

#include <sys/resource.h>

#include "model/block_encoder.h"
#include "model/format.h"
#include "model/round_trip.h"

namespace surfcast::model {
namespace {

/// A small model with every kind of content: colours, attributes, a grid, two sources, several blocks.
surfel::SurfelCloud small_cloud() {
  surfel::SurfelCloud cloud = sphere_cloud(150);
  const surfel::Grid grid{{0.01, 0.01, 0.01}, {10, 20, 30}};
  for (int i = 0; i < 30; ++i) cloud.positions.push_back(grid.position({i * i, 5 * i, -i}));
  cloud.colors->values.resize(cloud.positions.size());
  cloud.sources = {{"a.ply", 0, 150, std::nullopt}, {"b.las", 150, 30, grid}};
  cloud = finish_cloud(std::move(cloud));
  cloud.scalars.push_back({"gps_time", std::vector<double>(cloud.size(), 1e9 + 0.125)});
  number_surfels(cloud);
  return cloud;
}

std::vector<char> small_model(const TestFolder& folder) {
  write_and_open(small_cloud(), folder / "small.surf");
  return read_bytes(folder / "small.surf");
}

std::span<std::byte> as_bytes(std::vector<char>& bytes) {
  return std::as_writable_bytes(std::span(bytes));
}

void put_u64(std::vector<char>& bytes, size_t at, uint64_t value) {
  std::memcpy(bytes.data() + at, &value, sizeof(value));
}

uint64_t get_u64(const std::vector<char>& bytes, size_t at) {
  uint64_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

/// Corrects the checksums of tables and header, as an attacker would. Offsets as in docs/model-format.md.
void repair_checksums(std::vector<char>& bytes) {
  const std::span<std::byte> all = as_bytes(bytes);
  const uint64_t directory = get_u64(bytes, 24);
  if (directory <= bytes.size()) put_u64(bytes, 40, checksum_of(all.subspan(directory)));
  put_u64(bytes, 56, checksum_of(all.first(56)));
}

/// Opens a model and decodes all its blocks. Returns the first error.
Status read_all(const std::filesystem::path& path) {
  const Result<ModelFile> model = ModelFile::open(path);
  if (!model) return fail(model);
  for (size_t b = 0; b < model->blocks().size(); ++b) {
    const Result<DecodedBlock> block = model->decode(b);
    if (!block) return fail(block);
    if (block->size() != model->blocks()[b].items) return fail(ErrorKind::kInternal, "a wrong decode");
  }
  return {};
}

/// Overwrites the previous file, because creating thousands of files is slow.
Status read_all(const TestFolder& folder, const std::vector<char>& bytes) {
  const std::filesystem::path path = folder / "hostile.surf";
  std::ofstream(path, std::ios::binary | std::ios::app);
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (std::filesystem::file_size(path) != bytes.size()) std::filesystem::resize_file(path, bytes.size());
  return read_all(path);
}

TEST(HostileModel, EveryTruncationIsRefused) {
  const TestFolder folder;
  const std::vector<char> whole = small_model(folder);
  ASSERT_TRUE(read_all(folder, whole));
  for (size_t length = 0; length < whole.size(); ++length) {
    const Status status = read_all(folder, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)});
    ASSERT_FALSE(status) << length;
    ASSERT_EQ(status.error().kind, ErrorKind::kInvalidInput) << length;
    ASSERT_NE(status.error().message.find("hostile.surf: "), std::string::npos);
  }
}

TEST(HostileModel, BytesAfterTheEndAreRefused) {
  const TestFolder folder;
  std::vector<char> bytes = small_model(folder);
  bytes.push_back(0);
  EXPECT_FALSE(read_all(folder, bytes));
}

TEST(HostileModel, AnyFlippedBitIsNoticed) {
  const TestFolder folder;
  const std::vector<char> whole = small_model(folder);
  std::mt19937 random(1);
  for (int round = 0; round < 2000; ++round) {
    std::vector<char> bytes = whole;
    bytes[random() % bytes.size()] ^= static_cast<char>(1u << random() % 8);
    const Status status = read_all(folder, bytes);
    ASSERT_FALSE(status) << round;
    ASSERT_NE(status.error().kind, ErrorKind::kInternal) << status.error().message;
  }
}

TEST(HostileModel, WrongTablesWithRightChecksumsFailOrDecode) {
  const TestFolder folder;
  const std::vector<char> whole = small_model(folder);
  const uint64_t directory = get_u64(whole, 24);
  std::mt19937 random(2);
  for (int round = 0; round < 3000; ++round) {
    std::vector<char> bytes = whole;
    for (int flips = 0; flips < 3; ++flips) {
      bytes[directory + random() % (bytes.size() - directory)] ^= static_cast<char>(1u << random() % 8);
    }
    repair_checksums(bytes);
    const Status status = read_all(folder, bytes);
    if (!status) {
      ASSERT_NE(status.error().kind, ErrorKind::kInternal) << status.error().message;
    }
  }
}

TEST(HostileModel, WrongHeadersWithRightChecksumsFailOrDecode) {
  const TestFolder folder;
  const std::vector<char> whole = small_model(folder);
  std::mt19937 random(3);
  for (int round = 0; round < 2000; ++round) {
    std::vector<char> bytes = whole;
    bytes[12 + random() % (kHeaderBytes - 12)] ^= static_cast<char>(1u << random() % 8);
    put_u64(bytes, 56, checksum_of(as_bytes(bytes).first(56)));
    const Status status = read_all(folder, bytes);
    if (!status) {
      ASSERT_NE(status.error().kind, ErrorKind::kInternal) << status.error().message;
    }
  }
}

TEST(HostileModel, WrongBlocksWithRightChecksumsFailOrDecode) {
  surfel::SurfelCloud cloud = sphere_cloud(300);
  number_surfels(cloud);
  const std::vector<ScalarColumn> scalars{{"id", static_cast<ScalarCode>(cloud.scalars[0].values.index())}};
  const std::vector<uint32_t>& members = std::get<std::vector<uint32_t>>(cloud.scalars[0].values);
  const surfel::Grid grid{glm::dvec3(1e-4), glm::dvec3(0)};
  const EncodedBlock block = encode_block(cloud, members, grid);
  const BlockShape shape{grid, block.origin, block.extent, block.items, 8, scalars};
  ASSERT_TRUE(decode_block(block.bytes, shape, 1));

  std::mt19937 random(4);
  for (int round = 0; round < 3000; ++round) {
    std::vector<std::byte> bytes = block.bytes;
    for (int flips = 0; flips < 2; ++flips)
      bytes[random() % bytes.size()] ^= static_cast<std::byte>(1u << random() % 8);
    const Result<DecodedBlock> decoded = decode_block(bytes, shape, random() % 2);
    if (decoded) {
      ASSERT_EQ(decoded->size(), block.items);
    }
  }
  for (size_t length = 0; length < block.bytes.size(); ++length) {
    const Result<DecodedBlock> decoded = decode_block(std::span(block.bytes).first(length), shape, length % 2);
    if (decoded) {
      ASSERT_EQ(decoded->size(), block.items);
    }
  }
}

TEST(HostileModel, ABlockWithMoreSurfelsThanItsTableSaysIsRefused) {
  const surfel::SurfelCloud cloud = sphere_cloud(300);
  std::vector<uint32_t> members(300);
  std::iota(members.begin(), members.end(), 0);
  const surfel::Grid grid{glm::dvec3(1e-4), glm::dvec3(0)};
  const EncodedBlock block = encode_block(cloud, members, grid);
  EXPECT_FALSE(decode_block(block.bytes, {grid, block.origin, block.extent, 299, 8, {}}, 0));
  EXPECT_FALSE(decode_block(block.bytes, {grid, block.origin, block.extent / 2u, 300, 8, {}}, 0));
}

TEST(HostileModel, AHugeCountInTheTablesAllocatesNothing) {
  const TestFolder folder;
  const std::vector<char> whole = small_model(folder);
  const uint64_t directory = get_u64(whole, 24);
  rusage before{};
  getrusage(RUSAGE_SELF, &before);
  for (size_t at = directory; at + 4 <= whole.size(); ++at) {
    std::vector<char> bytes = whole;
    std::memset(bytes.data() + at, 0xff, 3);
    repair_checksums(bytes);
    const Status status = read_all(folder, bytes);
    if (!status) {
      ASSERT_NE(status.error().kind, ErrorKind::kInternal);
    }
  }
  rusage after{};
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 64 * 1024) << "KiB";
}

/// The parent and cell of an entry in a table of blocks whose checksums are correct.
struct Claim {
  uint32_t parent;
  ldc::OctreeKey key;
};

Status read_tree(const TestFolder& folder, const std::vector<Claim>& claims) {
  const std::vector<char> whole = small_model(folder);
  const ModelHeader header = *read_header(std::as_bytes(std::span(whole)));
  const auto tables = std::as_bytes(std::span(whole)).subspan(header.directory_offset);
  Directory directory = *read_directory(tables, header);
  const BlockRecord block = directory.blocks[0];
  directory.blocks.clear();
  for (const Claim& claim : claims) {
    directory.blocks.push_back(block);
    directory.blocks.back().parent = claim.parent;
    directory.blocks.back().key = claim.key;
  }
  std::vector<char> bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(header.directory_offset));
  const std::vector<std::byte> written = write_directory(directory);
  for (const std::byte byte : written) bytes.push_back(static_cast<char>(byte));
  put_u64(bytes, 16, bytes.size());
  put_u64(bytes, 32, written.size());
  repair_checksums(bytes);
  std::ofstream(folder / "tree.surf", std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  const Result<ModelFile> model = ModelFile::open(folder / "tree.surf");
  return model ? Status() : fail(model);
}

TEST(HostileModel, BlocksThatMakeNoTreeAreRefused) {
  const TestFolder folder;
  const ldc::OctreeKey root;
  const uint32_t none = ldc::BlockEntry::kNoParent;
  EXPECT_TRUE(read_tree(folder, {{none, root}, {0, root.child(1)}, {0, root}}));
  const std::vector<std::vector<Claim>> hostile{
      {{0, root}},                                                    // its own parent
      {{1, root}, {0, root.child(1)}},                                // a cycle
      {{none, root}, {7, root}},                                      // an absent parent
      {{none, root}, {none, root}, {0, root}, {1, root}, {0, root}},  // siblings not contiguous
      {{none, root.child(1)}, {0, root.child(2)}},                    // a child outside its parent's cell
      {{none, root.child(1)}, {0, root}},                             // a child larger than its parent
      {{none, root}, {0, root}, {1, root}, {2, root}, {3, root}},     // a path of equal cells
  };
  for (const std::vector<Claim>& claims : hostile) {
    const Status status = read_tree(folder, claims);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().kind, ErrorKind::kInvalidInput);
    EXPECT_NE(status.error().message.find("tree.surf: the blocks of the model make no tree"), std::string::npos);
  }
}

TEST(HostileModel, AnotherVersionIsNamedWithThoseThatAreRead) {
  const TestFolder folder;
  std::vector<char> bytes = small_model(folder);
  for (const char version : {char{0}, char{77}}) {
    bytes[8] = version;
    const Status status = read_all(folder, bytes);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().kind, ErrorKind::kUnsupported);
    EXPECT_NE(status.error().message.find("version " + std::to_string(version)), std::string::npos);
    EXPECT_NE(status.error().message.find("reads versions 2 to 6"), std::string::npos);
  }
}

TEST(HostileModel, OtherFilesAreNotModels) {
  const TestFolder folder;
  EXPECT_EQ(read_all(folder, {}).error().kind, ErrorKind::kInvalidInput);
  EXPECT_EQ(read_all(folder, std::vector<char>(1000, 'x')).error().kind, ErrorKind::kInvalidInput);
  EXPECT_EQ(read_all(folder / "absent.surf").error().kind, ErrorKind::kNotFound);
  EXPECT_EQ(read_all(folder / "").error().kind, ErrorKind::kIo);
}

}  // namespace
}  // namespace surfcast::model
