// Any damage to a model file results in an error within bounds of time and memory. A separate program, because it
// counts all allocated memory.

#include <array>
#include <cmath>
#include <numeric>
#include <random>

#include "model/block_encoder.h"
#include "model/damage.h"
#include "model/format.h"
#include "model/model_writer.h"
#include "model/round_trip.h"
#include "support/sample_size.h"

namespace surfcast::model {
namespace {

int sample_of_inputs() {
  return testing::sample_size("SURFCAST_DAMAGED_INPUTS", 2000);
}

surfel::SurfelCloud part_of_a_model(size_t count, bool leaf) {
  surfel::SurfelCloud cloud = sphere_cloud(count);
  std::mt19937 random(static_cast<uint32_t>(count));
  std::vector<uint16_t> intensity(count);
  for (uint16_t& value : intensity) value = static_cast<uint16_t>(random());
  if (leaf) cloud.scalars.push_back({"gps_time", std::vector<double>(count, 1e9 + 0.125)});
  cloud.scalars.push_back({"intensity", intensity});
  return cloud;
}

/// A model of three levels, with all optional content of blocks.
Bytes small_model(const TestFolder& folder) {
  const auto encode = [](const surfel::SurfelCloud& cloud) {
    std::vector<uint32_t> members(cloud.size());
    std::iota(members.begin(), members.end(), 0);
    return encode_block(cloud, members, {glm::dvec3(1e-4), glm::dvec3(0)});
  };
  const std::filesystem::path path = folder / "whole.surf";
  Result<ModelWriter> writer = ModelWriter::create(path, schema_of(part_of_a_model(1, true)));
  const ldc::OctreeKey root;
  const ldc::OctreeKey low = root.child(0);
  const uint32_t a = *writer->add(encode(part_of_a_model(200, true)), low.child(1), {});
  const uint32_t b = *writer->add(encode(part_of_a_model(300, true)), low.child(2), {});
  const uint32_t c = *writer->add(encode(part_of_a_model(100, true)), root.child(7), {});
  const uint32_t ab = *writer->add(encode(part_of_a_model(120, false)), low, std::array{a, b});
  EXPECT_TRUE(writer->add(encode(part_of_a_model(50, false)), root, std::array{c, ab}));
  EXPECT_TRUE(writer->finish());
  return content_of(path);
}

/// The statistics tables at the end of the small model: two counts of zero. They are optional.
constexpr size_t kStatisticsBytes = 8;

/// The offsets of the parts of a model file, and its end.
std::vector<size_t> boundaries_of(const Bytes& whole) {
  const ModelHeader header = *read_header(whole);
  Directory directory = *read_directory(std::span(whole).subspan(header.directory_offset), header);
  std::vector<size_t> boundaries = {0, kHeaderBytes, header.directory_offset, whole.size()};
  for (const BlockRecord& block : directory.blocks) {
    boundaries.push_back(block.offset);
    boundaries.push_back(block.offset + block.bytes);
  }
  // Removed tables shorten the directory, except for their counts of zero, which take four bytes each.
  const auto table_end = [&](size_t tables_left) {
    return header.directory_offset + write_directory(directory).size() - kStatisticsBytes - 4 * tables_left;
  };
  boundaries.push_back(whole.size() - kStatisticsBytes / 2);
  for (size_t left = directory.blocks.size(); left > 0; --left) {
    boundaries.push_back(table_end(0));
    directory.blocks.pop_back();
  }
  boundaries.push_back(table_end(1));
  directory.grids.clear();
  boundaries.push_back(table_end(2));
  directory.scalars.clear();
  boundaries.push_back(table_end(3));
  return boundaries;
}

bool usable(const DecodedBlock& block) {
  for (size_t i = 0; i < block.size(); ++i) {
    const glm::dvec3 position = block.position(i);
    if (!std::isfinite(position.x + position.y + position.z)) return false;
    if (!(block.radii[i] > 0) || !std::isfinite(block.radii[i]) || !(block.weights[i] > 0)) return false;
    if (std::abs(glm::length(block.normals[i]) - 1) > 1e-3f) return false;
  }
  return true;
}

Status read_all(const std::filesystem::path& path) {
  const Result<ModelFile> model = ModelFile::open(path);
  if (!model) return fail(model);
  for (size_t b = 0; b < model->blocks().size(); ++b) {
    const Result<DecodedBlock> block = model->decode(b);
    if (!block) return fail(block);
    if (block->size() != model->blocks()[b].items || !usable(*block)) {
      return fail(ErrorKind::kInternal, "a wrong decode");
    }
  }
  return {};
}

/// For a block of a few hundred surfels, independent of the file's claims.
constexpr size_t kOwnNeeds = 1 << 20;

Status read_within_bounds(const TestFolder& folder, const Bytes& bytes) {
  return read_within_bounds(folder, bytes, kOwnNeeds, read_all);
}

TEST(DamagedModel, TruncationAtAnyBoundaryIsRefused) {
  const TestFolder folder;
  const Bytes whole = small_model(folder);
  ASSERT_TRUE(read_within_bounds(folder, whole));
  const size_t directory = read_header(whole)->directory_offset;
  for (const size_t boundary : boundaries_of(whole)) {
    for (const size_t size : {boundary - 1, boundary, boundary + 1}) {
      if (size >= whole.size()) continue;
      Bytes bytes(whole.begin(), whole.begin() + static_cast<ptrdiff_t>(size));
      ASSERT_FALSE(read_within_bounds(folder, bytes)) << size;
      repair_tables(bytes, directory);
      const bool figures_alone_are_gone = size == whole.size() - kStatisticsBytes;
      ASSERT_EQ(read_within_bounds(folder, bytes).has_value(), figures_alone_are_gone)
          << size << " with right checksums";
    }
  }
}

TEST(DamagedModel, AnyChangedByteIsNoticed) {
  const TestFolder folder;
  const Bytes whole = small_model(folder);
  std::mt19937 random(1);
  const int rounds = sample_of_inputs();
  for (int round = 0; round < rounds; ++round) {
    Bytes bytes = whole;
    bytes[random() % bytes.size()] ^= static_cast<std::byte>(1 + random() % 255);
    ASSERT_FALSE(read_within_bounds(folder, bytes)) << round;
  }
}

TEST(DamagedModel, ChangedTablesWithRightChecksumsAreRefusedOrDecode) {
  const TestFolder folder;
  const Bytes whole = small_model(folder);
  const size_t directory = read_header(whole)->directory_offset;
  std::mt19937 random(2);
  const int rounds = sample_of_inputs();
  for (int round = 0; round < rounds && !::testing::Test::HasFailure(); ++round) {
    Bytes bytes = whole;
    bytes[directory + random() % (bytes.size() - directory)] ^= static_cast<std::byte>(1 + random() % 255);
    repair_tables(bytes, directory);
    static_cast<void>(read_within_bounds(folder, bytes));
  }
}

TEST(DamagedModel, ChangedBlocksWithRightChecksumsAreRefusedOrDecode) {
  const TestFolder folder;
  const Bytes whole = small_model(folder);
  const ModelHeader header = *read_header(whole);
  std::mt19937 random(3);
  const int rounds = sample_of_inputs();
  int decoded = 0;
  for (int round = 0; round < rounds && !::testing::Test::HasFailure(); ++round) {
    Bytes bytes = whole;
    const size_t at = kHeaderBytes + random() % (header.directory_offset - kHeaderBytes);
    bytes[at] ^= static_cast<std::byte>(1 + random() % 255);
    repair_blocks(bytes, whole);
    repair_tables(bytes, header.directory_offset);
    decoded += read_within_bounds(folder, bytes) ? 1 : 0;
  }
  EXPECT_GT(decoded, rounds / 100) << "blocks that still decode show that the checksums are right";
}

}  // namespace
}  // namespace surfcast::model
