// Scatter in model files: a field of the blocks that have it, and a version of its own.

#include <algorithm>
#include <cstring>

#include "model/fit_model.h"
#include "model/format.h"
#include "model/round_trip.h"

namespace surfcast::model {
namespace {

constexpr size_t kVersionAt = 8;

/// A sphere whose upper half is scatter: smaller splats at the same distances.
surfel::SurfelCloud half_scattered(size_t count) {
  surfel::SurfelCloud cloud = sphere_cloud(count);
  cloud.scatter.resize(count);
  for (size_t i = 0; i < count; ++i) {
    cloud.scatter[i] = cloud.positions[i].z > 0 ? 1 : 0;
    if (cloud.is_scatter(i)) cloud.radii[i] *= 0.3F;
  }
  return cloud;
}

TEST(ModelScatter, EverySurfelComesBackAsWhatItWas) {
  const TestFolder folder;
  const surfel::SurfelCloud cloud = half_scattered(40000);
  const DecodedModel model = round_trip(cloud, folder / "model.surf");
  for (size_t i = 0; i < cloud.size(); ++i) {
    const auto [block, at] = model.surfels[i];
    ASSERT_EQ(block->is_scatter(at), cloud.is_scatter(i)) << i;
    ASSERT_EQ(block->colors[at], cloud.colors->values[i]);
    ASSERT_NEAR(block->radii[at] / cloud.radii[i], 1, 0.001);
  }
}

TEST(ModelScatter, IsCounted) {
  const TestFolder folder;
  const surfel::SurfelCloud cloud = half_scattered(40000);
  const ModelFile model = write_and_open(cloud, folder / "model.surf");
  EXPECT_EQ(model.info().scatter, 20000U);
  EXPECT_EQ(model.info().surfels, 40000U);
}

TEST(ModelScatter, CostsAModelWithoutItNoByte) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(40000);
  ASSERT_TRUE(write_model(cloud, folder / "without.surf", {}));
  cloud.scatter.assign(cloud.size(), 0);
  ASSERT_TRUE(write_model(cloud, folder / "none.surf", {}));
  const std::vector<char> without = read_bytes(folder / "without.surf");
  EXPECT_EQ(without, read_bytes(folder / "none.surf"));
  EXPECT_EQ(without[kVersionAt], 2) << "older programs read it";
}

TEST(ModelScatter, HasAVersionThatOlderProgramsRefuse) {
  const TestFolder folder;
  ASSERT_TRUE(write_model(half_scattered(1000), folder / "model.surf", {}));
  EXPECT_EQ(read_bytes(folder / "model.surf")[kVersionAt], 4);
}

/// The unit direction from the focal point of the default camera to its eye.
glm::dvec3 first_direction(const ModelFile& model) {
  const geometry::Camera camera = fit_model(model, 1);
  return glm::normalize(camera.position - camera.focal_point);
}

TEST(ModelScatter, LeavesTheFirstViewToTheSideThatTheDiscsFace) {
  const TestFolder folder;
  for (const size_t count : {size_t{1000}, size_t{100000}}) {
    const glm::dvec3 all = first_direction(write_and_open(sphere_cloud(count), folder / "discs.surf"));
    const glm::dvec3 lower = first_direction(write_and_open(half_scattered(count), folder / "half.surf"));
    EXPECT_LT(lower.z, all.z - 0.3) << count << ": the discs of the lower half face down";
  }
}

TEST(ModelScatter, BlocksWithItHaveNoConeBecauseItIsSeenFromAllSides) {
  const TestFolder folder;
  const ModelFile model = write_and_open(half_scattered(100000), folder / "model.surf");
  size_t with = 0;
  size_t without = 0;
  for (size_t b = 0; b < model.blocks().size(); ++b) {
    const Result<DecodedBlock> block = model.decode(b);
    ASSERT_TRUE(block);
    const bool scatter = !block->scatter.empty();
    if (scatter) {
      EXPECT_FALSE(model.blocks()[b].normals);
    }
    if (model.blocks()[b].level > 0) continue;
    EXPECT_EQ(model.blocks()[b].normals.has_value(), !scatter);
    ++(scatter ? with : without);
  }
  EXPECT_GT(with, 0U);
  EXPECT_GT(without, 0U);
}

TEST(ModelScatter, SmallSplatsDoNotMakeTheLatticeOrTheSpacingOfDiscsFiner) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(3000);
  const ModelFile without = write_and_open(cloud, folder / "without.surf");
  cloud.scatter.assign(cloud.size(), 0);
  for (size_t i = 0; i < cloud.size(); i += 3) {
    cloud.scatter[i] = 1;
    cloud.radii[i] *= 0.05F;
  }
  const ModelFile with = write_and_open(cloud, folder / "with.surf");
  ASSERT_EQ(with.blocks().size(), without.blocks().size());
  EXPECT_EQ(with.decode(0)->grid, without.decode(0)->grid);
  EXPECT_EQ(with.blocks()[0].spacing, without.blocks()[0].spacing);
  EXPECT_EQ(with.blocks()[0].max_radius, without.blocks()[0].max_radius);
}

/// The bytes of a model, with `change` applied to its tables and all checksums right.
template <typename Change>
std::vector<char> with_tables(std::vector<char> bytes, Change change) {
  const auto all = std::as_bytes(std::span(bytes));
  ModelHeader header = *read_header(all);
  Directory directory = *read_directory(all.subspan(header.directory_offset), header);
  change(directory);
  const std::vector<std::byte> tables = write_directory(directory);
  header.version = directory.version();
  header.directory_bytes = tables.size();
  header.directory_checksum = checksum_of(tables);
  header.file_bytes = header.directory_offset + tables.size();
  const std::vector<std::byte> head = write_header(header);
  bytes.resize(header.file_bytes);
  std::memcpy(bytes.data(), head.data(), head.size());
  std::memcpy(bytes.data() + header.directory_offset, tables.data(), tables.size());
  return bytes;
}

Status decode_all(const std::filesystem::path& path) {
  const Result<ModelFile> model = ModelFile::open(path);
  if (!model) return fail(model);
  for (size_t b = 0; b < model->blocks().size(); ++b) {
    if (const Result<DecodedBlock> block = model->decode(b); !block) return fail(block);
  }
  return {};
}

void write_bytes(const std::filesystem::path& path, const std::vector<char>& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

TEST(ModelScatter, ACountThatItsBlockDoesNotHaveIsRefused) {
  const TestFolder folder;
  ASSERT_TRUE(write_model(half_scattered(1000), folder / "model.surf", {}));
  const std::vector<char> bytes = read_bytes(folder / "model.surf");
  write_bytes(folder / "same.surf", with_tables(bytes, [](Directory&) {}));
  EXPECT_TRUE(decode_all(folder / "same.surf"));
  for (const uint32_t wrong : {0U, 1U, 999U, 1001U}) {
    write_bytes(folder / "wrong.surf", with_tables(bytes, [&](Directory& d) { d.blocks[0].scatter = wrong; }));
    const Status status = decode_all(folder / "wrong.surf");
    ASSERT_FALSE(status) << wrong;
    EXPECT_EQ(status.error().kind, ErrorKind::kInvalidInput) << wrong;
  }
}

}  // namespace
}  // namespace surfcast::model
