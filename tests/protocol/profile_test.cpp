#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "protocol/profile_file.h"
#include "protocol/profile_query.h"
#include "scan/whole_scan.h"

namespace surfcast::protocol {
namespace {

/// Points on a lattice of millimetres, with attributes of LAS and others.
wire::Profile sample(int count) {
  wire::Profile profile;
  profile.set_color_bits(16);
  for (auto* vector : {profile.mutable_scale(), profile.mutable_offset()}) {
    const bool scale = vector == &profile.scale();
    vector->set_x(scale ? 0.001 : 448'262);
    vector->set_y(scale ? 0.001 : 5'411'932);
    vector->set_z(scale ? 0.01 : 0);
  }
  const std::vector<std::string> names{"intensity", "return_number", "number_of_returns", "classification",
                                       "gps_time",  "user_data",     "reflectance, dB"};
  for (const std::string& name : names) profile.add_attributes()->set_attribute(name);
  for (int i = 0; i < count; ++i) {
    profile.add_x((37 * i - 900) * 0.001 + 448'262);
    profile.add_y((i * i) * 0.001 + 5'411'932);
    profile.add_z((i % 5 - 2) * 0.01);
    profile.add_along(0.5 * i);
    profile.add_across(-0.25);
    profile.add_red(static_cast<uint32_t>(1000 + i));
    profile.add_green(static_cast<uint32_t>(65535 - i));
    profile.add_blue(3);
    const std::vector<double> values{600.0 + i, 1.0 + i % 3, 3, 6, 1e5 + i / 8.0, 200, -0.5 * i};
    for (int a = 0; a < static_cast<int>(values.size()); ++a) {
      profile.mutable_attributes(a)->add_values(values[static_cast<size_t>(a)]);
    }
  }
  return profile;
}

testing::WholeScan read_las(const std::string& file) {
  auto scan = testing::read_whole(std::as_bytes(std::span(file)), "profile.las");
  EXPECT_TRUE(scan) << (scan ? "" : scan.error().message);
  return scan ? std::move(*scan) : testing::WholeScan{};
}

double value_of(const testing::WholeScan& scan, const std::string& name, size_t point) {
  for (const surfel::ScalarAttribute& scalar : scan.scalars) {
    if (scalar.name != name) continue;
    return std::visit([&](const auto& values) { return static_cast<double>(values[point]); }, scalar.values);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

TEST(ProfileLas, IsReadBackToTheLastBit) {
  const wire::Profile profile = sample(200);
  ASSERT_TRUE(check_profile_answer(profile));
  const testing::WholeScan scan = read_las(profile_las(profile));
  ASSERT_EQ(scan.positions.size(), 200U);
  ASSERT_TRUE(scan.colors);
  for (int i = 0; i < 200; ++i) {
    const auto at = static_cast<size_t>(i);
    EXPECT_EQ(scan.positions[at], glm::dvec3(profile.x(i), profile.y(i), profile.z(i)));
    EXPECT_EQ(scan.colors->values[at], glm::u16vec3(profile.red(i), profile.green(i), profile.blue(i)));
    for (const wire::AttributeColumn& attribute : profile.attributes()) {
      EXPECT_EQ(value_of(scan, attribute.attribute(), at), attribute.values(i)) << attribute.attribute();
    }
  }
}

TEST(ProfileLas, WithoutColorsIsOfFormatSix) {
  wire::Profile profile = sample(3);
  profile.set_color_bits(0);
  profile.clear_red();
  profile.clear_green();
  profile.clear_blue();
  ASSERT_TRUE(check_profile_answer(profile));
  const std::string file = profile_las(profile);
  EXPECT_EQ(file[104], 6);
  EXPECT_EQ(read_las(file).positions.size(), 3U);
}

TEST(ProfileLas, BeyondThirtyTwoBitsOfTheLatticeIsCoarser) {
  wire::Profile profile = sample(2);
  profile.set_x(1, profile.x(0) + 1e9);
  profile.mutable_offset()->set_y(-1e12);
  profile.mutable_scale()->set_z(0);
  const testing::WholeScan scan = read_las(profile_las(profile));
  for (int i = 0; i < 2; ++i) {
    const glm::dvec3 point = scan.positions.at(static_cast<size_t>(i));
    EXPECT_NEAR(point.x, profile.x(i), 0.5);
    EXPECT_NEAR(point.y, profile.y(i), 0.001);
    EXPECT_NEAR(point.z, profile.z(i), 0.5);
  }
}

TEST(ProfileLas, OfNoPointsIsAFile) {
  const std::string file = profile_las({});
  EXPECT_EQ(file.size(), 375U);
  EXPECT_EQ(file.substr(0, 4), "LASF");
}

TEST(ProfileLas, ClampsWhatAFieldCannotHold) {
  wire::Profile profile = sample(1);
  profile.mutable_attributes(0)->set_values(0, 1e9);
  profile.mutable_attributes(1)->set_values(0, std::numeric_limits<double>::quiet_NaN());
  profile.mutable_attributes(3)->set_values(0, -5);
  const testing::WholeScan scan = read_las(profile_las(profile));
  EXPECT_EQ(value_of(scan, "intensity", 0), 65535);
}

TEST(ProfileCsv, NamesItsColumnsAndKeepsEveryDigit) {
  wire::Profile profile = sample(2);
  profile.mutable_attributes(6)->set_values(1, std::numeric_limits<double>::quiet_NaN());
  std::istringstream text(profile_csv(profile));
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line,
            "x,y,z,along,across,red,green,blue,intensity,return_number,number_of_returns,classification,gps_time,"
            "user_data,\"reflectance, dB\"\r");
  std::getline(text, line);
  EXPECT_EQ(line, "448261.1,5411932,-0.02,0,-0.25,1000,65535,3,600,1,3,6,1e+05,200,-0\r");
  std::getline(text, line);
  EXPECT_EQ(line.substr(line.rfind(',')), ",\r") << "no number, no text";
  EXPECT_EQ(std::stod(line), profile.x(1));
}

TEST(ProfileAnswer, ColumnsOfUnequalLengthAreRefused) {
  EXPECT_TRUE(check_profile_answer({}));
  wire::Profile profile = sample(4);
  profile.add_red(1);
  EXPECT_FALSE(check_profile_answer(profile));
  profile = sample(4);
  profile.mutable_attributes(2)->clear_values();
  EXPECT_FALSE(check_profile_answer(profile));
  profile = sample(4);
  profile.set_y(2, INFINITY);
  EXPECT_FALSE(check_profile_answer(profile));
}

TEST(ProfileQuery, IsALineAWidthAndAFormat) {
  const auto query = parse_profile_query("town", "line=1,2,3;4,5.5,-6&width=2.5&max_points=10&format=las");
  ASSERT_TRUE(query) << query.error().message;
  EXPECT_EQ(query->profile.model(), "town");
  ASSERT_EQ(query->profile.line_size(), 2);
  EXPECT_EQ(query->profile.line(1).z(), -6);
  EXPECT_EQ(query->profile.width(), 2.5);
  EXPECT_EQ(query->profile.max_points(), 10U);
  EXPECT_EQ(query->format, ProfileFormat::kLas);
  EXPECT_EQ(parse_profile_query("town", "line=1,2,3;4,5,6&width=1")->format, ProfileFormat::kCsv);
}

TEST(ProfileQuery, WrongOnesAreErrors) {
  std::string longest = "line=0,0,0";
  for (int i = 0; i < 1024; ++i) longest += ";1,2,3";
  for (const std::string& query :
       {std::string("width=1"), std::string("line=1,2,3;4,5,6"), std::string("line=1,2,3&width=1"),
        std::string("line=1,2;3,4&width=1"), std::string("line=1,2,3;4,5,6;&width=1"),
        std::string("line=1,2,3;4,5,nan&width=1"), std::string("line=1,2,3;4,5,6&width=0"),
        std::string("line=1,2,3;4,5,6&width=inf"), std::string("line=1,2,3;4,5,6&width=1&max_points=0"),
        std::string("line=1,2,3;4,5,6&width=1&format=laz"), std::string("line=1,2,3;4,5,6&width=1&color=red"),
        longest + "&width=1"}) {
    const auto parsed = parse_profile_query("town", query);
    ASSERT_FALSE(parsed) << query;
    EXPECT_EQ(parsed.error().kind, ErrorKind::kInvalidInput) << query;
  }
}

TEST(CheckProfile, WhatNoQueryCouldSayIsCaughtInMessagesToo) {
  const auto refused = [](auto spoil) {
    wire::GetProfile profile = parse_profile_query("m", "line=1,2,3;4,5,6&width=1")->profile;
    spoil(profile);
    return !check_profile(profile);
  };
  EXPECT_FALSE(refused([](auto&) {}));
  EXPECT_TRUE(refused([](auto& p) { p.clear_model(); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_model(std::string(600, 'x')); }));
  EXPECT_TRUE(refused([](auto& p) { p.clear_line(); }));
  EXPECT_TRUE(refused([](auto& p) { p.mutable_line(1)->set_y(NAN); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_width(NAN); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_width(-INFINITY); }));
  EXPECT_TRUE(refused([](auto& p) {
    while (p.line_size() <= kMaxProfileLine) p.add_line();
  }));
}

}  // namespace
}  // namespace surfcast::protocol
