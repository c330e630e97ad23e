// Any damage to a model file results in an error within bounds of time and memory. A separate program, because it
// counts all allocated memory.

#include <array>
#include <cmath>
#include <cstring>
#include <ctime>
#include <numeric>
#include <random>

#include "model/block_encoder.h"
#include "model/counted_memory.h"
#include "model/format.h"
#include "model/model_writer.h"
#include "model/round_trip.h"

namespace surfcast::model {
namespace {

using Bytes = std::vector<std::byte>;

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
  const std::vector<char> content = read_bytes(path);
  const auto bytes = std::as_bytes(std::span(content));
  return {bytes.begin(), bytes.end()};
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

void put(Bytes& bytes, size_t at, uint64_t value) {
  if (at + sizeof(value) <= bytes.size()) std::memcpy(&bytes[at], &value, sizeof(value));
}

/// Corrects the size and the checksums of header and tables, as an attacker would. Offsets as in docs/model-format.md.
void repair_tables(Bytes& bytes, size_t directory) {
  if (bytes.size() < kHeaderBytes) return;
  put(bytes, 16, bytes.size());
  directory = std::min(directory, bytes.size());
  put(bytes, 24, directory);
  put(bytes, 32, bytes.size() - directory);
  put(bytes, 40, checksum_of(std::span(bytes).subspan(directory)));
  put(bytes, 56, checksum_of(std::span(bytes).first(56)));
}

/// Corrects the checksum of each block; the tables are those of the undamaged file.
void repair_blocks(Bytes& bytes, const std::vector<BlockRecord>& blocks) {
  const size_t first_record = bytes.size() - kStatisticsBytes - blocks.size() * kBlockRecordBytes;
  for (size_t i = 0; i < blocks.size(); ++i) {
    const auto content = std::span(bytes).subspan(blocks[i].offset, blocks[i].bytes);
    put(bytes, first_record + i * kBlockRecordBytes + 8, checksum_of(content));
  }
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
  if (!model) return fail(model.error());
  for (size_t b = 0; b < model->blocks().size(); ++b) {
    const Result<DecodedBlock> block = model->decode(b);
    if (!block) return fail(block.error());
    if (block->size() != model->blocks()[b].surfels || !usable(*block)) {
      return fail(ErrorKind::kInternal, "a wrong decode");
    }
  }
  return {};
}

double processor_seconds() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}

/// Overwrites the previous file, because creating thousands of files is slow.
void overwrite(const std::filesystem::path& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::app);
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (std::filesystem::file_size(path) != bytes.size()) std::filesystem::resize_file(path, bytes.size());
}

/// Reads a whole file. Checks the time, the memory and the form of the error.
Status read_within_bounds(const TestFolder& folder, const Bytes& bytes) {
  constexpr size_t kOwnNeeds = 1 << 20;  // for a block of a few hundred surfels, independent of the file's claims
  const std::filesystem::path path = folder / "damaged.surf";
  overwrite(path, bytes);
  const size_t before = bytes_in_use();
  start_peak();
  const double start = processor_seconds();
  const Status status = read_all(path);
  EXPECT_LT(processor_seconds() - start, 1);
  EXPECT_LT(peak_bytes_in_use() - before, 2 * bytes.size() + kOwnNeeds);
  if (!status) {
    EXPECT_TRUE(status.error().kind == ErrorKind::kInvalidInput || status.error().kind == ErrorKind::kUnsupported)
        << status.error().message;
    EXPECT_NE(status.error().message.find("damaged.surf: "), std::string::npos) << status.error().message;
  }
  return status;
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
  for (int round = 0; round < 5000; ++round) {
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
  for (int round = 0; round < 5000 && !::testing::Test::HasFailure(); ++round) {
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
  const Directory tables = *read_directory(std::span(whole).subspan(header.directory_offset), header);
  std::mt19937 random(3);
  int decoded = 0;
  for (int round = 0; round < 10000 && !::testing::Test::HasFailure(); ++round) {
    Bytes bytes = whole;
    const size_t at = kHeaderBytes + random() % (header.directory_offset - kHeaderBytes);
    bytes[at] ^= static_cast<std::byte>(1 + random() % 255);
    repair_blocks(bytes, tables.blocks);
    repair_tables(bytes, header.directory_offset);
    decoded += read_within_bounds(folder, bytes) ? 1 : 0;
  }
  EXPECT_GT(decoded, 100) << "blocks that still decode show that the checksums are right";
}

}  // namespace
}  // namespace surfcast::model
