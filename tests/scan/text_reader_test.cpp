#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/bytes.h"
#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

using testing::as_bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::scalar_values;

testing::WholeScan read_text(const std::string& text) {
  const Result<testing::WholeScan> points = testing::read_whole(as_bytes(text), "scan.xyz");
  EXPECT_TRUE(points) << points.error().message;
  return points ? *points : testing::WholeScan{};
}

std::string text_message_for(const std::string& text) {
  const Result<testing::WholeScan> points = testing::read_whole(as_bytes(text), "scan.xyz");
  return points ? "" : points.error().message;
}

TEST(TextReaderTest, SeparatorsAndLineEndsOfAllKinds) {
  for (const std::string text : {"1 2 3\n4 5 6\n", "1\t2\t3\r\n4\t5\t6", "1,2,3\n4,5,6\n", "1;2;3\n\n4; 5 ;6;\n",
                                 "\xEF\xBB\xBF  1  2 3 \n4 , 5, 6\n", "# made by hand\n1 2 3\n// more\n4 5 6\n"}) {
    EXPECT_THAT(read_text(text).positions, ElementsAre(glm::dvec3(1, 2, 3), glm::dvec3(4, 5, 6))) << text;
  }
}

TEST(TextReaderTest, CoordinatesAreTheNearestDoubles) {
  EXPECT_EQ(read_text("665187.522077 5648349.895035 -0.1e-3").positions[0],
            glm::dvec3(665187.522077, 5648349.895035, -0.1e-3));
}

TEST(TextReaderTest, DecimalCommasAreAnErrorNotTwoNumbers) {
  EXPECT_THAT(text_message_for("1,5;2,5;3,5\n"), HasSubstr("does not name x, y and z: 1,5;2,5;3,5"));
  EXPECT_THAT(text_message_for("x;y;z\n1,5;2,5;3,5\n"), HasSubstr("not a table of numbers"));
}

TEST(TextReaderTest, HeaderNamesColumnsInAnyOrderAndCase) {
  for (const std::string header : {"Z,Intensity,\"X\",Y,R,G,B,Quality\n", "# z intensity x y r g b Quality\n",
                                   "//Z Intensity X Y R G B Quality\n"}) {
    const ScanPoints points = read_text(header + "3,70000,1,2,10,20,30,0.5\n");
    EXPECT_THAT(points.positions, ElementsAre(glm::dvec3(1, 2, 3)));
    EXPECT_THAT(scalar_values<uint32_t>(points, "intensity"), ElementsAre(70000U));
    EXPECT_THAT(scalar_values<double>(points, "Quality"), ElementsAre(0.5));
    ASSERT_TRUE(points.colors);
    EXPECT_THAT(points.colors->values, ElementsAre(glm::u16vec3(10, 20, 30)));
  }
}

TEST(TextReaderTest, HeaderMustNameCoordinatesAndMatchTheRows) {
  EXPECT_THAT(text_message_for("a b c\n1 2 3\n"), HasSubstr("does not name x, y and z"));
  EXPECT_THAT(text_message_for("x y z i\n1 2 3\n"), HasSubstr("names 4 columns"));
  EXPECT_THAT(text_message_for("x y z\nnor numbers here\n"), HasSubstr("not a table of numbers"));
}

TEST(TextReaderTest, FourthOfFourColumnsIsIntensity) {
  EXPECT_THAT(scalar_values<int16_t>(read_text("1 2 3 -5\n1 2 3 1000\n"), "intensity"), ElementsAre(-5, 1000));
}

TEST(TextReaderTest, SixColumnsAreColourOrNormalByTheirValues) {
  const ScanPoints colored = read_text("1 2 3 0 128 255\n1 2 3 7 8 9\n");
  ASSERT_TRUE(colored.colors);
  EXPECT_EQ(colored.colors->bits, 8);
  EXPECT_THAT(colored.colors->values, ElementsAre(glm::u16vec3(0, 128, 255), glm::u16vec3(7, 8, 9)));
  const ScanPoints deep = read_text("1 2 3 0 128 65535\n");
  ASSERT_TRUE(deep.colors);
  EXPECT_EQ(deep.colors->bits, 16);
  const ScanPoints fractions = read_text("1 2 3 0 0.5 1\n1 2 3 0 0.25 0.25\n");
  ASSERT_TRUE(fractions.colors);
  EXPECT_THAT(fractions.colors->values, ElementsAre(glm::u16vec3(0, 32768, 65535), glm::u16vec3(0, 16384, 16384)));
  const ScanPoints normals = read_text("1 2 3 0 -0.6 0.8\n1 2 3 0 0 0\n");
  EXPECT_THAT(normals.normals, ElementsAre(glm::vec3(0, -0.6, 0.8), glm::vec3(0)));
  EXPECT_FALSE(normals.colors);
}

TEST(TextReaderTest, SevenColumnsAreIntensityAndColourUnlessTheLastIsOpaqueAlphaOrNoColour) {
  const ScanPoints pts = read_text("2\n1 2 3 -1613 52 70 64\n1 2 3 17 1 2 255\n");
  EXPECT_THAT(scalar_values<int16_t>(pts, "intensity"), ElementsAre(-1613, 17));
  EXPECT_THAT(pts.colors->values, ElementsAre(glm::u16vec3(52, 70, 64), glm::u16vec3(1, 2, 255)));
  const ScanPoints alpha = read_text("1 2 3 117.0 73.0 49.0 255.0\n1 2 3 1 2 3 255\n");
  EXPECT_THAT(alpha.colors->values, ElementsAre(glm::u16vec3(117, 73, 49), glm::u16vec3(1, 2, 3)));
  EXPECT_THAT(scalar_values<uint8_t>(alpha, "alpha"), ElementsAre(255, 255));
  const ScanPoints scalar = read_text("1 2 3 117 73 49 -0.5\n");
  EXPECT_THAT(scalar.colors->values, ElementsAre(glm::u16vec3(117, 73, 49)));
  EXPECT_THAT(scalar_values<double>(scalar, "column_7"), ElementsAre(-0.5));
  const ScanPoints plain = read_text("1 2 3 9 10 20 30\n1 2 3 8 40 50 60\n");
  EXPECT_THAT(scalar_values<uint8_t>(plain, "intensity"), ElementsAre(9, 8));
}

TEST(TextReaderTest, OneIsOpaqueWhereNoAlphaIsLarger) {
  EXPECT_THAT(scalar_values<double>(read_text("x y z alpha\n1 2 3 1\n1 2 3 0\n"), "alpha"), ElementsAre(1, 0));
  EXPECT_THAT(scalar_values<double>(read_text("x y z alpha\n1 2 3 1\n1 2 3 0.5\n"), "alpha"), ElementsAre(1, 0.5));
  EXPECT_THAT(scalar_values<uint8_t>(read_text("x y z alpha\n1 2 3 0\n1 2 3 200\n"), "alpha"), ElementsAre(0, 200));
}

TEST(TextReaderTest, NineAndTenColumnsHoldColourAndNormal) {
  const ScanPoints nine = read_text("1 2 3 10 20 30 0 0 -1\n");
  EXPECT_THAT(nine.colors->values, ElementsAre(glm::u16vec3(10, 20, 30)));
  EXPECT_THAT(nine.normals, ElementsAre(glm::vec3(0, 0, -1)));
  EXPECT_THAT(nine.scalars, IsEmpty());
  const ScanPoints ten = read_text("1 2 3 0.25 0 0 -1 10 20 30\n");
  EXPECT_THAT(ten.colors->values, ElementsAre(glm::u16vec3(10, 20, 30)));
  EXPECT_THAT(ten.normals, ElementsAre(glm::vec3(0, 0, -1)));
  EXPECT_THAT(scalar_values<double>(ten, "intensity"), ElementsAre(0.25));
}

TEST(TextReaderTest, CountOfPtsFilesIsChecked) {
  EXPECT_EQ(read_text("2\n1 2 3\n4 5 6\n").size(), 2u);
  EXPECT_EQ(read_text("1\n1 2 3\n2\n4 5 6\n7 8 9\n").size(), 3u);
  EXPECT_THAT(text_message_for("3\n1 2 3\n4 5 6\n"), HasSubstr("truncated: the file states 3 points and holds 2"));
  EXPECT_THAT(text_message_for("1\n1 2 3\n2\n4 5 6\n"), HasSubstr("states 3"));
}

TEST(TextReaderTest, BadRowsAreNamedByTheirLine) {
  EXPECT_THAT(text_message_for("1 2 3\n4 5 6\n7 8\n"), HasSubstr("line 3 does not fit the first row: 7 8"));
  EXPECT_THAT(text_message_for("1 2 3\n4 5 6 7\n"), HasSubstr("line 2"));
  EXPECT_THAT(text_message_for("1 2 3\n4 5 six\n"), HasSubstr("line 2"));
  EXPECT_THAT(text_message_for("1 2 3\n4,,6\n"), HasSubstr("line 2"));
  EXPECT_THAT(text_message_for("1 2\n"), HasSubstr("fewer than three"));
  EXPECT_THAT(text_message_for("\n\n"), HasSubstr("no points"));
}

TEST(TextReaderTest, LargeFilesReadInPartsKeepTheOrderAndTheLineNumbers) {
  std::string text;
  constexpr int kRows = 200000;  // several parts of 1 MiB
  for (int i = 0; i < kRows; ++i) text += std::to_string(i) + " 2 3\n";
  const ScanPoints points = read_text(text);
  ASSERT_EQ(points.size(), static_cast<size_t>(kRows));
  for (int i = 0; i < kRows; ++i) ASSERT_EQ(points.positions[static_cast<size_t>(i)].x, i);
  EXPECT_THAT(text_message_for(text + "1 2\n"), HasSubstr("line 200001"));
}

}  // namespace
}  // namespace surfcast::scan
