// Any damage to a model of volumes or of Gaussians results in an error within bounds of time and memory. A separate
// program, because it counts all allocated memory.

#include <cmath>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "gaussian/gaussian_block.h"
#include "gaussian/random_gaussians.h"
#include "kinds/kind_table.h"
#include "model/damage.h"
#include "model/format.h"
#include "model/model_writer.h"
#include "support/sample_size.h"
#include "volume/brick_block.h"
#include "volume/brick_coding.h"
#include "volume/pyramid.h"

namespace surfcast::kinds {
namespace {

using model::Bytes;
using model::TestFolder;

constexpr int kSample = 500;
constexpr size_t kOwnNeeds = 4 << 20;  // for a brick or a block of Gaussians, independent of the file's claims

/// The bytes of a finished model.
Bytes finished(model::ModelWriter& writer, const std::filesystem::path& target) {
  const Result<model::WriteReport> report = writer.finish();
  EXPECT_TRUE(report) << (report ? "" : report.error().message);
  return model::content_of(target);
}

model::Volume wave_volume(const glm::u32vec3& size) {
  model::Volume volume;
  volume.name = "waves";
  volume.size = size;
  volume.index_to_world = glm::dmat4x3(glm::dmat4(glm::dmat3(1, 0, 0, 0, 2, 0, 0, 0, 3)));
  volume.low = 20;
  volume.high = 220;
  volume.histogram.assign(model::kHistogramBins, 0);
  volume.histogram[0] = volume.samples();
  return volume;
}

/// A volume of two levels: two bricks and the one that stands for them.
Bytes volumes(const TestFolder& folder) {
  const model::Volume volume = wave_volume({40, 9, 7});
  Result<model::ModelWriter> writer = model::ModelWriter::create(folder / "whole.surf", {});
  std::vector<uint32_t> finest;
  std::optional<volume::Pyramid<float>> pyramid;
  pyramid.emplace(volume.size, [&](uint32_t level, uint32_t k) -> Status {
    for (uint32_t i = 0; i < volume::level_bricks(volume.size, level).x; ++i) {
      volume::BrickHeader place;
      place.level = level;
      place.brick = {i, 0, k};
      place.count = volume::brick_count(volume.size, level, place.brick);
      const volume::SampleScale scale{1, 0, level == 0 ? 1 : 0.125};
      const volume::Brick brick = volume::make_brick(place, pyramid->samples(level, place.brick), scale);
      const Result<uint32_t> block = writer->add(volume::brick_block(brick, volume, volume::bounds_lattice(volume)),
                                                 volume::brick_key(volume.size, level, place.brick),
                                                 level == 0 ? std::vector<uint32_t>() : finest);
      if (!block) return fail(block);
      finest.push_back(*block);
    }
    return {};
  });
  for (uint32_t k = 0; k < volume.size.z; ++k) {
    const std::span<float> plane = pyramid->next_plane();
    for (size_t i = 0; i < plane.size(); ++i) {
      plane[i] = std::round(120 + 100 * std::sin(0.1F * static_cast<float>(k * plane.size() + i)));
    }
    EXPECT_TRUE(pyramid->add_plane());
  }
  EXPECT_EQ(finest.size(), 3U);
  writer->set_volumes({volume});
  return finished(*writer, folder / "whole.surf");
}

Bytes gaussians(const TestFolder& folder) {
  model::ModelSchema schema;
  schema.color_bits = 8;
  schema.harmonics_degree = 3;
  Result<model::ModelWriter> writer = model::ModelWriter::create(folder / "whole.surf", schema);
  EXPECT_TRUE(
      writer->add(gaussian::encode_gaussians(gaussian::random_gaussians(200, 3), {.degree = 3}), ldc::OctreeKey(), {}));
  return finished(*writer, folder / "whole.surf");
}

struct Source {
  const char* name;
  Bytes (*make)(const TestFolder& folder);
};

/// Loads every block for the GPU, and decodes it for picks.
Status read_all(const std::filesystem::path& path) {
  const Result<model::ModelFile> model = model::ModelFile::open(path);
  if (!model) return fail(model);
  const Result<std::vector<uint32_t>> numbers = find_kinds(*model, built_in_kinds());
  if (!numbers) return fail(ErrorKind::kUnsupported, path.string() + ": " + numbers.error().message);
  for (uint32_t block = 0; block < model->blocks().size(); ++block) {
    const Kind& kind = *built_in_kinds()[(*numbers)[model->blocks()[block].kind]];
    const Result<residency::PackedBlock> packed = kind.load(*model, block, true);
    if (!packed) return fail(packed);
    if (const auto decoded = kind.decode(*model, block); !decoded) return fail(decoded);
  }
  return {};
}

Status read_within_bounds(const TestFolder& folder, const Bytes& bytes) {
  return model::read_within_bounds(folder, bytes, kOwnNeeds, read_all);
}

class DamagedKinds : public ::testing::TestWithParam<Source> {
 protected:
  void SetUp() override {
    whole_ = GetParam().make(folder_);
    header_ = *model::read_header(whole_);
    ASSERT_TRUE(read_within_bounds(folder_, whole_));
  }
  [[nodiscard]] Bytes cut(size_t size) const {
    return {whole_.begin(), whole_.begin() + static_cast<std::ptrdiff_t>(size)};
  }
  [[nodiscard]] Bytes flipped(size_t first, size_t end, std::mt19937& random) const {
    Bytes bytes = whole_;
    bytes[first + random() % (end - first)] ^= static_cast<std::byte>(1 + random() % 255);
    return bytes;
  }

  TestFolder folder_;
  Bytes whole_;
  model::ModelHeader header_;
};

TEST_P(DamagedKinds, TruncationAtAnyBlockIsRefused) {
  const auto tables = std::span(whole_).subspan(header_.directory_offset);
  const model::Directory directory = *model::read_directory(tables, header_);
  for (const model::BlockRecord& block : directory.blocks) {
    for (const size_t boundary : {size_t{block.offset}, size_t{block.offset + block.bytes}}) {
      for (const size_t size : {boundary - 1, boundary, boundary + 1}) {
        Bytes bytes = cut(size);
        EXPECT_FALSE(read_within_bounds(folder_, bytes)) << size;
        model::repair_tables(bytes, header_.directory_offset);
        EXPECT_FALSE(read_within_bounds(folder_, bytes)) << size << " with right checksums";
      }
    }
  }
}

TEST_P(DamagedKinds, TruncationAnywhereInTheTablesIsRefused) {
  for (size_t size = header_.directory_offset; size < whole_.size(); ++size) {
    Bytes bytes = cut(size);
    model::repair_tables(bytes, header_.directory_offset);
    ASSERT_FALSE(read_within_bounds(folder_, bytes)) << size;
  }
}

TEST_P(DamagedKinds, AnyChangedByteIsNoticed) {
  std::mt19937 random(1);
  for (int round = 0; round < 3000; ++round) {
    ASSERT_FALSE(read_within_bounds(folder_, flipped(0, whole_.size(), random))) << round;
  }
}

TEST_P(DamagedKinds, ChangedTablesWithRightChecksumsAreRefusedOrDecode) {
  std::mt19937 random(2);
  for (int rounds = testing::sample_size("SURFCAST_DAMAGED_INPUTS", kSample); rounds > 0 && !HasFailure(); --rounds) {
    Bytes bytes = flipped(header_.directory_offset, whole_.size(), random);
    model::repair_tables(bytes, header_.directory_offset);
    static_cast<void>(read_within_bounds(folder_, bytes));
  }
}

TEST_P(DamagedKinds, ChangedBlocksWithRightChecksumsAreRefusedOrDecode) {
  std::mt19937 random(3);
  int decoded = 0;
  for (int rounds = testing::sample_size("SURFCAST_DAMAGED_INPUTS", kSample); rounds > 0 && !HasFailure(); --rounds) {
    Bytes bytes = flipped(model::kHeaderBytes, header_.directory_offset, random);
    model::repair_blocks(bytes, whole_);
    model::repair_tables(bytes, header_.directory_offset);
    decoded += read_within_bounds(folder_, bytes) ? 1 : 0;
  }
  EXPECT_GT(decoded, 0) << "blocks that still decode show that the checksums are right";
}

INSTANTIATE_TEST_SUITE_P(Sources, DamagedKinds,
                         ::testing::Values(Source{"Volumes", volumes}, Source{"Gaussians", gaussians}),
                         [](const auto& source) { return std::string(source.param.name); });

}  // namespace
}  // namespace surfcast::kinds
