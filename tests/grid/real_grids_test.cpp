#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "grid/grid_reader.h"
#include "support/digest_table.h"
#include "support/sha256.h"

namespace surfcast::grid {
namespace {

struct Digest {
  std::string hash;
  uint64_t count = 0;
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  double sum = 0;
};

/// Reads all samples, in slices.
Result<Digest> digest_of(GridReader& reader) {
  const GridHeader& header = reader.header();
  std::vector<double> slice(header.size[0] * header.size[1] * header.components());
  testing::Sha256 hash;
  Digest digest;
  for (uint64_t k = 0; k < header.size[2]; ++k) {
    if (Status status = reader.read(std::span(slice)); !status) return fail(status);
    hash.add_values<double>(slice);
    for (const double value : slice) {
      digest.min = std::min(digest.min, value);
      digest.max = std::max(digest.max, value);
      digest.sum += value;
    }
    digest.count += slice.size();
  }
  digest.hash = hash.finish();
  return digest;
}

/// Compares with what other decoders have read. Skipped without a folder of real files.
TEST(RealGridsTest, EveryFileHasTheSamplesOfItsDigest) {
  const auto folder = testing::real_data();
  if (!folder) GTEST_SKIP() << "SURFCAST_REAL_DATA names no folder";
  std::vector<testing::DigestRow> rows = testing::digest_rows(*folder, "volumes");
  for (testing::DigestRow& row : testing::digest_rows(*folder, "tensors")) rows.push_back(row);
  ASSERT_FALSE(rows.empty());
  for (const testing::DigestRow& row : rows) {
    if (row.file.ends_with("tensors.vtk")) continue;  // not a regular grid
    SCOPED_TRACE(row.file);
    Result<GridReader> reader = GridReader::open(*folder / row.file);
    ASSERT_TRUE(reader) << reader.error().message;
    const Result<Digest> digest = digest_of(*reader);
    ASSERT_TRUE(digest) << digest.error().message;
    EXPECT_EQ(digest->hash, row.values);
    EXPECT_EQ(digest->count, row.count);
    EXPECT_EQ(digest->min, std::stod(row.min));
    EXPECT_EQ(digest->max, std::stod(row.max));
    EXPECT_NEAR(digest->sum / static_cast<double>(digest->count), std::stod(row.mean), 1e-9);
  }
}

}  // namespace
}  // namespace surfcast::grid
