#include "model/field.h"

#include <limits>
#include <random>
#include <string_view>

#include <gtest/gtest.h>

#include "model/path_order.h"

namespace surfcast::model {
namespace {

constexpr uint64_t kMax = std::numeric_limits<uint64_t>::max();

std::vector<Field> decoded_again(const std::vector<Field>& fields) {
  std::vector<size_t> columns;
  for (const Field& field : fields) columns.push_back(field.size());
  const auto rows = static_cast<uint32_t>(fields.front().front().size());
  Result<std::vector<Field>> decoded = decode_fields(encode_fields(fields), columns, rows, fields.size());
  EXPECT_TRUE(decoded);
  return decoded ? std::move(*decoded) : std::vector<Field>();
}

TEST(Field, PackingFindsBaseStrideAndLargest) {
  const ColumnPacking packing = choose_packing({1000, 1257 + 257, 1257});
  EXPECT_EQ(packing.base, 1000u);
  EXPECT_EQ(packing.stride, 257u);
  EXPECT_EQ(packing.largest, 2u);
}

TEST(Field, PackingOfAConstantStoresNothing) {
  EXPECT_EQ(choose_packing({7, 7, 7}).largest, 0u);
  EXPECT_EQ(choose_packing({7, 7, 7}).stride, 1u);
}

TEST(Field, PackingSpansTheWholeRange) {
  const ColumnPacking packing = choose_packing({kMax, 0, 1});
  EXPECT_EQ(packing.base, 0u);
  EXPECT_EQ(packing.largest, kMax);
}

TEST(Field, ValuesOfEveryWidthComeBackInOrder) {
  std::mt19937_64 random(1);
  std::vector<Field> fields;
  for (int bits = 0; bits <= 64; ++bits) {
    Column column;
    for (int i = 0; i < 50; ++i) column.push_back(bits == 0 ? 99 : random() >> (64 - bits));
    fields.push_back({column});
  }
  EXPECT_EQ(decoded_again(fields), fields);
}

TEST(Field, ColumnsOfOneFieldMayDifferInRange) {
  const std::vector<Field> fields{{{1, 2, 3}, {kMax, 0, 5}, {8, 8, 8}}, {{4, 4, 4}}};
  EXPECT_EQ(decoded_again(fields), fields);
}

TEST(Field, AllConstantColumnsNeedNoDracoData) {
  const std::vector<Field> fields{{Column(1000, 5), Column(1000, kMax)}};
  EXPECT_LT(encode_fields(fields).size(), 20u);
  EXPECT_EQ(decoded_again(fields), fields);
}

TEST(Field, RandomValuesOfAnyWidthAreNotTooLongToBeRead) {
  std::mt19937_64 random(3);
  for (const size_t rows : {1, 2, 100, 3000, 32768}) {
    std::vector<Field> fields;
    for (const int bits : {3, 9, 16, 31, 64}) {
      Field field(1 + static_cast<size_t>(bits) % 3, Column(rows));
      for (Column& column : field) {
        for (uint64_t& value : column) value = random() >> (64 - bits);
      }
      fields.push_back(field);
    }
    EXPECT_EQ(decoded_again(fields), fields) << rows;
  }
}

TEST(Field, DracoDataFarLongerThanItsTableIsRefused) {
  const std::vector<Field> fields{{{1, 2, 3}}};
  std::vector<std::byte> bytes = encode_fields(fields);
  bytes.resize(bytes.size() + 70000);
  const Result<std::vector<Field>> decoded = decode_fields(bytes, std::vector<size_t>{1}, 3, 1);
  ASSERT_FALSE(decoded);
  EXPECT_NE(decoded.error().message.find("too long"), std::string::npos);
}

TEST(Field, DracoDataThatStatesOtherAttributesIsRefusedBeforeItIsDecoded) {
  const std::vector<Field> fields{{{1, 2, 3}}, {{4, 9, 7000}}};
  const std::vector<std::byte> whole = encode_fields(fields);
  const std::string_view magic = "DRACO";
  const auto text = std::search(whole.begin(), whole.end(), magic.begin(), magic.end(),
                                [](std::byte a, char b) { return a == static_cast<std::byte>(b); });
  const auto draco = static_cast<size_t>(text - whole.begin());
  // Bytes from offset 15: number of attribute groups, number of attributes, then kind, type and components of the
  // first.
  for (const size_t at : {15, 16, 18, 19}) {
    std::vector<std::byte> bytes = whole;
    bytes.at(draco + at) = std::byte{100};
    const Result<std::vector<Field>> decoded = decode_fields(bytes, std::vector<size_t>{1, 1}, 3, 2);
    ASSERT_FALSE(decoded) << at;
    EXPECT_NE(decoded.error().message.find("states another shape"), std::string::npos) << at;
  }
}

TEST(Field, BytesOfAnotherShapeAreRefused) {
  const std::vector<Field> fields{{{1, 2, 3}}, {{4, 9, 7000}}};
  const std::vector<std::byte> bytes = encode_fields(fields);
  const std::vector<size_t> right{1, 1};
  const std::vector<size_t> joined{2};
  const std::vector<size_t> more{1, 1, 1};
  EXPECT_TRUE(decode_fields(bytes, right, 3, right.size()));
  EXPECT_FALSE(decode_fields(bytes, right, 4, right.size()));
  EXPECT_FALSE(decode_fields(bytes, joined, 3, joined.size()));
  EXPECT_FALSE(decode_fields(bytes, more, 3, more.size()));
  EXPECT_FALSE(decode_fields({}, right, 3, right.size()));
}

TEST(Field, TheFirstFieldsAloneAreTheSame) {
  std::mt19937_64 random(3);
  std::vector<Field> fields;
  for (const int bits : {8, 0, 40, 64, 0, 16}) {
    Field field(bits == 8 ? 3 : 1);
    for (Column& column : field) {
      for (int i = 0; i < 500; ++i) column.push_back(bits == 0 ? 7 : random() >> (64 - bits));
    }
    fields.push_back(field);
  }
  const std::vector<size_t> columns{3, 1, 1, 1, 1, 1};
  const std::vector<std::byte> bytes = encode_fields(fields);
  for (size_t wanted = 0; wanted <= fields.size(); ++wanted) {
    const Result<std::vector<Field>> decoded = decode_fields(bytes, columns, 500, wanted);
    ASSERT_TRUE(decoded) << wanted;
    EXPECT_EQ(*decoded, std::vector<Field>(fields.begin(), fields.begin() + static_cast<std::ptrdiff_t>(wanted)));
  }
}

TEST(PathOrder, VisitsEveryPointOnce) {
  std::mt19937 random(1);
  std::vector<glm::ivec3> points;
  for (int i = 0; i < 1000; ++i) points.emplace_back(random() % 100, random() % 100, random() % 3);
  std::vector<uint32_t> order = path_order(points);
  std::sort(order.begin(), order.end());
  for (uint32_t i = 0; i < 1000; ++i) ASSERT_EQ(order[i], i);
}

TEST(PathOrder, FollowsALineThatIsGivenInDisorder) {
  const std::vector<glm::ivec3> points{{0, 0, 0}, {3, 0, 0}, {1, 0, 0}, {4, 0, 0}, {2, 0, 0}};
  EXPECT_EQ(path_order(points), (std::vector<uint32_t>{0, 2, 4, 1, 3}));
}

TEST(PathOrder, OfNothingIsNothing) {
  EXPECT_TRUE(path_order({}).empty());
}

}  // namespace
}  // namespace surfcast::model
