// Any damage to a model of volumes or of Gaussians results in an error within bounds of time and memory. A separate
// program, because it counts all allocated memory.

#include <array>
#include <cmath>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "gaussian/gaussian_scenes.h"
#include "kinds/kind_table.h"
#include "model/damage.h"
#include "model/format.h"
#include "support/sample_size.h"

namespace surfcast::kinds {
namespace {

using model::Bytes;
using model::TestFolder;

constexpr int kSample = 1500;
constexpr size_t kOwnNeeds = 4 << 20;  // for a brick or a block of Gaussians, independent of the file's claims

Bytes built(const TestFolder& folder, const std::filesystem::path& input) {
  const std::filesystem::path target = folder / "whole.surf";
  const auto report = builder::build_model(std::array{input}, target, {}, [](const builder::BuildStep&) {});
  EXPECT_TRUE(report) << (report ? "" : report.error().message);
  return model::content_of(target);
}

/// A volume of two levels.
Bytes volumes(const TestFolder& folder) {
  std::ofstream file(folder / "grid.nrrd", std::ios::binary);
  file << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 40 9 7\nspacings: 1 2 3\nencoding: raw\n\n";
  for (int i = 0; i < 40 * 9 * 7; ++i) file.put(static_cast<char>(static_cast<uint8_t>(120 + 100 * std::sin(0.1 * i))));
  file.close();
  return built(folder, folder / "grid.nrrd");
}

Bytes gaussians(const TestFolder& folder) {
  reference::GaussianModel model = reference::make_gaussian_model("needles");
  model.splats.resize(200);
  return built(folder, testing::write_ply(folder / "needles.ply", model));
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
