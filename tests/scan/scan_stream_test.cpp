#include "scan/scan_stream.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <span>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "scan/bytes.h"
#include "scan/samples.h"
#include "scan/whole_scan.h"

namespace surfcast::scan {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::Sample;
using ::testing::StartsWith;

Result<testing::WholeScan> read(const std::string& name, std::string_view text) {
  return testing::read_whole(testing::as_bytes(text), fs::path("folder") / name);
}

/// What holds for every scan that was read.
void expect_consistent(const ScanPoints& points) {
  EXPECT_GT(points.size(), 0u);
  EXPECT_TRUE(points.normals.empty() || points.normals.size() == points.size());
  EXPECT_TRUE(points.radii.empty() || points.radii.size() == points.size());
  EXPECT_TRUE(!points.colors || points.colors->values.size() == points.size());
  for (const surfel::ScalarAttribute& scalar : points.scalars)
    EXPECT_EQ(surfel::value_count(scalar.values), points.size());
}

TEST(ScanStreamTest, EverySampleIsReadAndKeepsItsName) {
  for (const Sample& sample : testing::samples()) {
    const Result<testing::WholeScan> points = read(sample.name, sample.text);
    ASSERT_TRUE(points) << points.error().message;
    EXPECT_EQ(points->name, sample.name);
    expect_consistent(*points);
  }
}

TEST(ScanStreamTest, ContentDecidesBeforeTheExtension) {
  for (const Sample& sample : testing::samples()) {
    EXPECT_TRUE(read(sample.name + ".bin", sample.text)) << sample.name;
  }
}

TEST(ScanStreamTest, EveryTruncationFailsOrReadsFully) {
  for (const Sample& sample : testing::samples()) {
    for (size_t size = 0; size < sample.text.size(); ++size) {
      const Result<testing::WholeScan> points = read(sample.name, std::string_view(sample.text).substr(0, size));
      if (points) {
        expect_consistent(*points);
      } else {
        EXPECT_THAT(points.error().message, HasSubstr(sample.name + ": "));
      }
    }
  }
}

TEST(ScanStreamTest, BinaryFormatsFailOnEveryTruncation) {
  for (const Sample& sample : testing::samples()) {
    const std::string extension = fs::path(sample.name).extension();
    const bool is_text = sample.name.starts_with("ascii") || extension == ".xyz" || extension == ".pts" ||
                         extension == ".csv" || extension == ".ptx" || extension == ".asc";
    for (size_t size = 0; !is_text && size < sample.text.size(); ++size) {
      EXPECT_FALSE(read(sample.name, std::string_view(sample.text).substr(0, size))) << sample.name << " " << size;
    }
  }
}

TEST(ScanStreamTest, RandomDamageNeverCrashes) {
  std::mt19937 random(20240611);
  for (const Sample& sample : testing::samples()) {
    for (int round = 0; round < 400; ++round) {
      std::string damaged = sample.text;
      for (int i = 0; i <= round % 4; ++i) damaged[random() % damaged.size()] = static_cast<char>(random());
      const Result<testing::WholeScan> points = read(sample.name, damaged);
      if (points) expect_consistent(*points);
    }
  }
}

TEST(ScanStreamTest, OtherFilesGetOneLineThatSaysWhatTheyAre) {
  const std::pair<const char*, std::string> others[] = {
      {"a.gltf", R"({"asset": {"version": "2.0"}})"},
      {"a.spz", "\x1F\x8B"},
      {"a.obj", "v 1 2 3\n"},
      {"a.pts", "[Expe/PointSet/ASCII/0.1]\n"},
      {"a.json", "{}"},
      {"a.splat", "\1\2\3\4"},
      {"a.unknown", "\1\2\3\4"},
  };
  for (const auto& [name, text] : others) {
    const Result<testing::WholeScan> points = read(name, text);
    ASSERT_FALSE(points) << name;
    EXPECT_EQ(points.error().kind, ErrorKind::kUnsupported);
    EXPECT_THAT(points.error().message, StartsWith("folder/" + std::string(name) + ": "));
    EXPECT_EQ(points.error().message.find('\n'), std::string::npos);
  }
}

TEST(ScanStreamTest, FilesAreReadFromTheDisk) {
  const fs::path path = fs::path(::testing::TempDir()) / ("scan_stream_test_" + std::to_string(::getpid()) + ".xyz");
  ASSERT_TRUE(write_file_atomically(path, "1 2 3\n"));
  const Result<testing::WholeScan> points = testing::whole(ScanStream::open(path));
  fs::remove(path);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(points->name, path.filename());
  EXPECT_EQ(testing::whole(ScanStream::open(path)).error().kind, ErrorKind::kNotFound);
}

TEST(ScanStreamTest, ReopenedScansAreThoseThatWereOpened) {
  Selection selection;
  selection.every = 2;
  for (const Sample& sample : testing::samples()) {
    const fs::path path =
        fs::path(::testing::TempDir()) / ("reopened_" + std::to_string(::getpid()) + "_" + sample.name);
    ASSERT_TRUE(write_file_atomically(path, sample.text));
    const Result<ScanStream> opened = ScanStream::open(path, {}, {}, selection);
    ASSERT_TRUE(opened) << opened.error().message;
    const Result<ScanStream> reopened = ScanStream::reopen(path, {}, selection, opened->facts());
    ASSERT_TRUE(reopened) << reopened.error().message;
    EXPECT_EQ(reopened->size(), opened->size());
    EXPECT_EQ(reopened->schema().scalars, opened->schema().scalars);
    ASSERT_EQ(reopened->pieces(), opened->pieces());
    for (size_t piece = 0; piece < opened->pieces(); ++piece) {
      const Result<ScanPoints> points = reopened->read(piece);
      ASSERT_TRUE(points);
      const ScanPoints expected = opened->read(piece).value();
      const auto bytes = [](const auto& values) { return std::as_bytes(std::span(values)); };  // some are no numbers
      EXPECT_TRUE(std::ranges::equal(bytes(points->positions), bytes(expected.positions))) << sample.name;
      ASSERT_EQ(points->colors.has_value(), expected.colors.has_value()) << sample.name;
      const auto colors = [](const ScanPoints& of) {
        return of.colors ? of.colors->values : decltype(of.colors->values)();
      };
      EXPECT_EQ(colors(*points), colors(expected)) << sample.name;
    }
    fs::remove(path);
  }
}

TEST(ScanStreamTest, FilesThatMissTheirHeaderAreRefused) {
  EXPECT_THAT(read("a.pcd", "1 2 3\n").error().message, HasSubstr("PCD header missing"));
  EXPECT_THAT(read("a.las", std::string(300, '\0')).error().message, HasSubstr("not a LAS file"));
  EXPECT_THAT(read("a.ply", "").error().message, HasSubstr("empty"));
}

TEST(ScanStreamTest, DefaultViewpointFarFromThePointsIsNoSensor) {
  const std::string fields = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
  const std::string header = testing::pcd_header(fields, 1, 2, "ascii");
  EXPECT_TRUE(read("near.pcd", header + "-1 0 1\n1 0 1\n")->sensor);
  EXPECT_FALSE(read("far.pcd", header + "5000 0 0\n5001 0 0\n")->sensor);
}

TEST(ScanStreamTest, FormatsDecodedWholeAreRefusedWhereMemoryDoesNotSuffice) {
  for (const Sample& sample : testing::samples()) {
    const fs::path path =
        fs::path(::testing::TempDir()) / ("limited_" + std::to_string(::getpid()) + "_" + sample.name);
    std::ofstream(path, std::ios::binary) << sample.text;
    const Result<ScanStream> stream = ScanStream::open(path, {16});
    const bool whole = sample.text.starts_with("DRACO") || sample.text.find("binary_compressed") != std::string::npos;
    EXPECT_EQ(stream.has_value(), !whole) << sample.name;
    if (whole) {
      EXPECT_THAT(stream.error().message, HasSubstr("can only be decoded whole")) << sample.name;
    }
    fs::remove(path);
  }
}

}  // namespace
}  // namespace surfcast::scan
