#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gaussian/gaussian_reader.h"
#include "support/digest_table.h"
#include "support/sha256.h"

namespace surfcast::gaussian {
namespace {

struct Range {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  void include(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }
};

struct Digest {
  Range opacity;
  std::array<Range, 3> scales;
  testing::Sha256 positions;
  testing::Sha256 colors;
  uint64_t count = 0;
  glm::dvec3 min{std::numeric_limits<double>::infinity()};
  glm::dvec3 max{-std::numeric_limits<double>::infinity()};
  glm::dvec3 sum{0.0};
};

uint8_t color_of(float coefficient) {
  const double color = 0.5 + kConstantHarmonic * static_cast<double>(coefficient);
  return static_cast<uint8_t>(std::rint(255 * std::clamp(color, 0.0, 1.0)));
}

void include(const Gaussians& gaussians, size_t width, Digest& digest) {
  for (size_t i = 0; i < gaussians.size(); ++i) {
    const glm::dvec3& p = gaussians.positions[i];
    const std::array<double, 3> xyz = {p.x, p.y, p.z};
    digest.positions.add_values<double>(xyz);
    const float* dc = &gaussians.harmonics[i * width];
    const std::array<uint8_t, 3> rgb = {color_of(dc[0]), color_of(dc[1]), color_of(dc[2])};
    digest.colors.add_values<uint8_t>(rgb);
    digest.min = glm::min(digest.min, p);
    digest.max = glm::max(digest.max, p);
    digest.sum += p;
    digest.opacity.include(gaussians.opacities[i]);
    for (int axis = 0; axis < 3; ++axis) digest.scales[static_cast<size_t>(axis)].include(gaussians.scales[i][axis]);
  }
  digest.count += gaussians.size();
}

void expect_vector(const glm::dvec3& actual, const std::string& cell, double tolerance) {
  const std::vector<double> expected = testing::numbers_in(cell);
  ASSERT_EQ(expected.size(), 3u);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(actual[axis], expected[static_cast<size_t>(axis)], tolerance);
}

/// The range "name=min..max" of an attribute, as the file stores it.
std::optional<Range> stated_range(const std::string& attributes, const std::string& name) {
  const size_t at = (";" + attributes).find(";" + name + "=");
  if (at == std::string::npos) return std::nullopt;
  const std::string range = attributes.substr(at + name.size() + 1);
  return Range{std::stod(range), std::stod(range.substr(range.find("..") + 2))};
}

void expect_range(const Range& actual, const Range& stated) {
  EXPECT_NEAR(actual.min, stated.min, 1e-5 * std::abs(stated.min) + 1e-9);
  EXPECT_NEAR(actual.max, stated.max, 1e-5 * std::abs(stated.max) + 1e-9);
}

/// Bytes of opacity are 255 times the opacity, logits their inverse. Scales are logarithms but for .splat.
void expect_attributes(const Digest& digest, const testing::DigestRow& row) {
  const auto logit = [](double x) { return std::log(x / (1 - x)); };
  const auto byte = [](double x) { return std::rint(255 * x); };
  const Range& o = digest.opacity;
  if (const auto alpha = stated_range(row.attributes, "alpha")) expect_range({byte(o.min), byte(o.max)}, *alpha);
  if (const auto stated = stated_range(row.attributes, "opacity")) expect_range({logit(o.min), logit(o.max)}, *stated);
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto stated = stated_range(row.attributes, "scale_" + std::to_string(axis));
    const Range& s = digest.scales[axis];
    const bool linear = row.file.ends_with(".splat");
    if (stated) expect_range(linear ? s : Range{std::log(s.min), std::log(s.max)}, *stated);
  }
}

/// Compares with what other decoders have read. Skipped without a folder of real files.
TEST(RealGaussiansTest, EveryFileHasThePositionsAndColoursOfItsDigest) {
  const auto folder = testing::real_data();
  if (!folder) GTEST_SKIP() << "SURFCAST_REAL_DATA names no folder";
  const std::vector<testing::DigestRow> rows = testing::digest_rows(*folder, "splats");
  ASSERT_FALSE(rows.empty());
  for (const testing::DigestRow& row : rows) {
    SCOPED_TRACE(row.file);
    Result<GaussianReader> reader = GaussianReader::open(*folder / row.file);
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ(reader->traits().count, row.count);
    Digest digest;
    while (reader->position() < reader->traits().count) {
      const Result<Gaussians> part = reader->read(10007);
      ASSERT_TRUE(part) << part.error().message;
      EXPECT_EQ(part->unusable, 0u);
      include(*part, harmonics_of(reader->traits().degree) * 3, digest);
    }
    EXPECT_EQ(digest.count, row.count);
    expect_attributes(digest, row);
    EXPECT_EQ(digest.positions.finish(), row.values);
    EXPECT_EQ(digest.colors.finish(), row.colors);
    expect_vector(digest.min, row.min, 0);
    expect_vector(digest.max, row.max, 0);
    expect_vector(digest.sum / static_cast<double>(digest.count), row.mean, 1e-9);
  }
}

}  // namespace
}  // namespace surfcast::gaussian
