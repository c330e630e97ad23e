// Volumes in model files: tables of version 5.

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <random>

#include "model/format.h"
#include "model/kind_tables.h"
#include "model/model_writer.h"
#include "model/round_trip.h"

namespace surfcast::model {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Volume small_volume() {
  Volume volume;
  volume.name = "brain";
  volume.size = {40, 33, 1};
  volume.index_to_world = {{0, 2, 0}, {-3, 0.5, 0}, {0, 0, 1e-4}, {5e6, -1, 0.1}};
  volume.frame = WorldFrame::kLps;
  volume.length_unit = "mm";
  volume.sample_unit = "HU";
  volume.type = 3;
  volume.slope = -0.5;
  volume.intercept = -1024;
  volume.low = -1500.5;
  volume.high = 3000;
  volume.histogram.assign(kHistogramBins, 0);
  volume.histogram.front() = 20;
  volume.histogram.back() = 40 * 33 - 20;
  return volume;
}

/// A brick whose bytes nothing interprets.
EncodedBlock brick_block(uint32_t level, const glm::u32vec3& brick) {
  EncodedBlock block;
  block.bytes.assign(7, std::byte{42});
  block.items = 5;
  block.spacing = block.max_radius = level == 0 ? 1.0F : 2.0F;
  block.kind = kGridKind;
  block.brick = {0, level, brick, -1500.5F, 3000};
  return block;
}

std::filesystem::path write_volume(const TestFolder& folder) {
  Result<ModelWriter> writer = ModelWriter::create(folder / "brain.surf", {});
  EXPECT_TRUE(writer);
  const ldc::OctreeKey root;
  std::vector<uint32_t> children;
  for (uint32_t octant = 0; octant < 4; ++octant) {
    const glm::u32vec3 brick(octant % 2, octant / 2, 0);
    children.push_back(*writer->add(brick_block(0, brick), root.child(octant), {}));
  }
  EXPECT_TRUE(writer->add(brick_block(1, {0, 0, 0}), root, children));
  writer->set_volumes({small_volume()});
  EXPECT_TRUE(writer->finish());
  return folder / "brain.surf";
}

/// The tables of the file above.
struct Tables {
  ModelHeader header;
  Directory directory;
};
Tables small_tables(const TestFolder& folder) {
  const std::vector<char> bytes = read_bytes(write_volume(folder));
  const auto all = std::as_bytes(std::span(bytes));
  const ModelHeader header = *read_header(all);
  return {header, *read_directory(all.subspan(header.directory_offset), header)};
}

Result<Directory> reread(const Tables& tables) {
  const std::vector<std::byte> bytes = write_directory(tables.directory);
  ModelHeader header = tables.header;
  header.directory_checksum = checksum_of(bytes);
  return read_directory(bytes, header);
}

TEST(ModelVolumes, ComeBackWithTheirBricks) {
  const TestFolder folder;
  const Result<ModelFile> model = ModelFile::open(write_volume(folder));
  ASSERT_TRUE(model) << model.error().message;
  ASSERT_EQ(model->volumes().size(), 1U);
  const Volume& volume = model->volumes().front();
  const Volume wanted = small_volume();
  EXPECT_EQ(volume.name, wanted.name);
  EXPECT_EQ(volume.size, wanted.size);
  EXPECT_EQ(volume.index_to_world, wanted.index_to_world);
  EXPECT_EQ(volume.frame, wanted.frame);
  EXPECT_EQ(volume.length_unit, wanted.length_unit);
  EXPECT_EQ(volume.sample_unit, wanted.sample_unit);
  EXPECT_EQ(volume.type, wanted.type);
  EXPECT_EQ(volume.slope, wanted.slope);
  EXPECT_EQ(volume.intercept, wanted.intercept);
  EXPECT_EQ(volume.low, wanted.low);
  EXPECT_EQ(volume.high, wanted.high);
  EXPECT_EQ(volume.histogram, wanted.histogram);
  ASSERT_EQ(model->blocks().size(), 5U);
  EXPECT_EQ(model->brick(0).level, 1U) << "parents come before children";
  for (uint32_t octant = 0; octant < 4; ++octant) {
    EXPECT_EQ(model->brick(1 + octant).brick, glm::u32vec3(octant % 2, octant / 2, 0));
    EXPECT_EQ(model->brick(1 + octant).low, -1500.5F);
    EXPECT_EQ(model->brick(1 + octant).high, 3000.0F);
  }
}

TEST(ModelVolumes, HaveAVersionThatOlderProgramsRefuse) {
  const TestFolder folder;
  EXPECT_EQ(read_bytes(write_volume(folder))[8], 5);
}

TEST(ModelVolumes, WrongOnesAreRefused) {
  const TestFolder folder;
  const Tables tables = small_tables(folder);
  ASSERT_TRUE(reread(tables));
  const std::vector<std::function<void(Volume&)>> faults{
      [](Volume& v) { v.size.y = 0; },
      [](Volume& v) { v.size = glm::u32vec3(kMaxAxisSamples + 1, 1, 1); },
      [](Volume& v) { v.size = glm::u32vec3(kMaxAxisSamples); },
      [](Volume& v) { v.index_to_world[3][1] = kNan; },
      [](Volume& v) { v.frame = WorldFrame{4}; },
      [](Volume& v) { v.type = 10; },
      [](Volume& v) { v.slope = 0; },
      [](Volume& v) { v.intercept = kNan; },
      [](Volume& v) { v.low = 4000; },
      [](Volume& v) { v.high = std::numeric_limits<double>::infinity(); },
      [](Volume& v) { v.histogram[1] = 1; },
      [](Volume& v) { v.histogram[1] = UINT64_MAX; },
      [](Volume& v) { v.histogram[0] = 19; },
  };
  for (size_t i = 0; i < faults.size(); ++i) {
    Tables wrong = tables;
    faults[i](wrong.directory.volumes.front());
    const Result<Directory> read = reread(wrong);
    ASSERT_FALSE(read) << i;
    EXPECT_EQ(read.error().message, "model has a wrong volume") << i;
  }
}

TEST(ModelVolumes, WrongBricksAreRefused) {
  const TestFolder folder;
  const Tables tables = small_tables(folder);
  const std::vector<std::function<void(BrickRecord&)>> faults{
      [](BrickRecord& b) { b.volume = 1; },
      [](BrickRecord& b) { b.level = 2; },
      [](BrickRecord& b) { b.level = 200; },
      [](BrickRecord& b) { b.brick.x = 2; },
      [](BrickRecord& b) { b.brick.z = UINT32_MAX; },
      [](BrickRecord& b) { b.low = 3001; },
      [](BrickRecord& b) { b.high = std::numeric_limits<float>::quiet_NaN(); },
  };
  for (size_t i = 0; i < faults.size(); ++i) {
    Tables wrong = tables;
    faults[i](wrong.directory.bricks[2]);
    const Result<Directory> read = reread(wrong);
    ASSERT_FALSE(read) << i;
    EXPECT_EQ(read.error().message, "model has a wrong brick") << i;
  }
}

TEST(ModelVolumes, BricksThatDoNotLieWhereTheirParentIsAreRefused) {
  const TestFolder folder;
  const Tables tables = small_tables(folder);
  for (const BlockRecord& block : tables.directory.blocks) EXPECT_TRUE(is_within_pyramid(tables.directory, block));
  Tables wrong = tables;
  wrong.directory.bricks[wrong.directory.blocks[2].brick].level = 1;
  EXPECT_FALSE(is_within_pyramid(wrong.directory, wrong.directory.blocks[2]));
  wrong = tables;
  wrong.directory.blocks[3].parent = ldc::BlockEntry::kNoParent;
  EXPECT_FALSE(is_within_pyramid(wrong.directory, wrong.directory.blocks[3])) << "only the top level is a root";
}

TEST(ModelVolumes, BricksWithoutVolumesAreRefused) {
  const TestFolder folder;
  Tables tables = small_tables(folder);
  tables.directory.volumes.clear();
  tables.header.version = tables.directory.version();
  EXPECT_EQ(tables.header.version, kKindsVersion);
  const Result<Directory> read = reread(tables);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message, "model has bricks but no volumes");
}

TEST(ModelVolumes, EveryTruncationOfTheirTablesIsRefused) {
  const TestFolder folder;
  const Tables tables = small_tables(folder);
  const std::vector<std::byte> whole = write_directory(tables.directory);
  for (size_t length = 0; length < whole.size(); length += length + 400 < whole.size() ? 13 : 1) {
    ModelHeader header = tables.header;
    const std::span<const std::byte> bytes = std::span(whole).first(length);
    header.directory_checksum = checksum_of(bytes);
    ASSERT_FALSE(read_directory(bytes, header)) << length;
  }
}

TEST(ModelVolumes, CountsBeyondTheFileTakeNoMemory) {
  const TestFolder folder;
  const Tables tables = small_tables(folder);
  std::vector<std::byte> bytes = write_directory(tables.directory);
  // The count of volumes stands before the tables of the one volume and of five bricks.
  Directory without = tables.directory;
  without.volumes.clear();
  const size_t at = write_directory(without).size() + 5 * sizeof(uint32_t);
  uint32_t count = 0;
  std::memcpy(&count, bytes.data() + at, sizeof count);
  ASSERT_EQ(count, 1U);
  for (const uint32_t wrong : {2U, 1000000U, UINT32_MAX}) {
    std::memcpy(bytes.data() + at, &wrong, sizeof wrong);
    ModelHeader header = tables.header;
    header.directory_checksum = checksum_of(bytes);
    ASSERT_FALSE(read_directory(bytes, header)) << wrong;
  }
}

TEST(ModelVolumes, WrongTablesWithRightChecksumsFailOrOpen) {
  const TestFolder folder;
  const Tables tables = small_tables(folder);
  const std::vector<std::byte> whole = write_directory(tables.directory);
  std::mt19937 random(5);
  for (int round = 0; round < 3000; ++round) {
    std::vector<std::byte> bytes = whole;
    // Half of the changes are in the bricks, at the end.
    const size_t range = round % 2 == 0 ? bytes.size() : 5 * 28;
    for (int flips = 0; flips < 2; ++flips) {
      bytes[bytes.size() - 1 - random() % range] ^= static_cast<std::byte>(1U << random() % 8);
    }
    ModelHeader header = tables.header;
    header.directory_checksum = checksum_of(bytes);
    const Result<Directory> read = read_directory(bytes, header);
    if (!read) continue;
    for (const BrickRecord& brick : read->bricks) {
      ASSERT_LT(brick.volume, read->volumes.size());
      ASSERT_LE(brick.low, brick.high);
    }
  }
}

}  // namespace
}  // namespace surfcast::model
