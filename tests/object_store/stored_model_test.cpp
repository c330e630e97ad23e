#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/run_program.h"
#include "model/round_trip.h"
#include "object_store/range_server.h"
#include "support/path_of.h"

namespace surfcast::object_store {
namespace {

using testing::Fault;
using ::testing::HasSubstr;
using testing::RangeServer;
using ::testing::StartsWith;

constexpr const char* kPath = "/models/sphere.surf";

std::string content(const std::filesystem::path& path) {
  const std::vector<char> bytes = model::read_bytes(path);
  return {bytes.begin(), bytes.end()};
}

/// The program itself draws a model that a server holds, which fails as it is told.
class StoredModelTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ::setenv("no_proxy", "127.0.0.1", 1);
    write(folder_ / "sphere.surf", false);
    server_.put(kPath, content(folder_ / "sphere.surf"));
  }

  /// A sphere, coloured by the directions of its surface; `other`: in other colours.
  static void write(const std::filesystem::path& path, bool other) {
    surfel::SurfelCloud cloud = model::sphere_cloud(600'000);
    if (other) {
      for (glm::u16vec3& color : cloud.colors->values) std::swap(color.x, color.z);
    }
    const auto report = model::write_model(cloud, path, {});
    ASSERT_TRUE(report) << report.error().message;
  }

  /// Draws all of a model at its finest level.
  [[nodiscard]] client::ProgramOutcome draw(const std::string& model, const std::string& flags = {}) const {
    return client::run_program(path_of("surfcastd") + " render " + model +
                               " --resolution 160,120 --spacing 0 --output " + picture() + " --stats " + stats() +
                               " --store-timeout 3 --store-stall-timeout 0.3 " + flags + " 2>&1 >/dev/null");
  }
  [[nodiscard]] std::string local() const { return (folder_ / "sphere.surf").string(); }
  [[nodiscard]] std::string picture() const { return (folder_ / "picture.png").string(); }
  [[nodiscard]] std::string stats() const { return (folder_ / "stats.json").string(); }

  /// The picture of a model file.
  [[nodiscard]] std::string picture_of(const std::string& model) const {
    const client::ProgramOutcome outcome = draw(model);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    return content(picture());
  }

  /// Mean over the leaves, all of which have about as many surfels.
  [[nodiscard]] double bytes_of_a_leaf() const {
    const auto model = model::ModelFile::open(local());
    uint64_t bytes = 0;
    size_t leaves = 0;
    for (const ldc::BlockEntry& block : model->blocks()) {
      if (block.level > 0) continue;
      bytes += block.bytes;
      ++leaves;
    }
    return static_cast<double>(bytes) / static_cast<double>(leaves);
  }

  model::TestFolder folder_;
  RangeServer server_;
};

TEST_F(StoredModelTest, ThePictureIsThatOfTheFileForAQuarterOfTheRequestsAndLittleMoreThanTheBlocks) {
  const std::string expected = picture_of(local());
  const client::ProgramOutcome outcome = draw(server_.url(kPath));
  ASSERT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_TRUE(content(picture()) == expected);

  const nlohmann::json drawn = nlohmann::json::parse(content(stats()));
  const auto blocks = drawn.at("blocks_waited_for").get<size_t>();
  EXPECT_GE(blocks, 20U);
  EXPECT_LE(4 * server_.requests().size(), blocks);
  EXPECT_LE(static_cast<double>(server_.bytes()), 1.3 * bytes_of_a_leaf() * static_cast<double>(blocks));
}

TEST_F(StoredModelTest, InspectSaysOfTheUrlWhatItSaysOfTheFile) {
  const auto inspect = [&](const std::string& model) {
    const client::ProgramOutcome outcome =
        client::run_program(path_of("surfcastd") + " inspect --verify --json " + model);
    EXPECT_EQ(outcome.code, 0);
    nlohmann::json summary = nlohmann::json::parse(outcome.output);
    return summary;
  };
  nlohmann::json remote = inspect(server_.url(kPath));
  nlohmann::json file = inspect(local());
  EXPECT_EQ(remote["bytes"], file["bytes"]);
  for (nlohmann::json* summary : {&remote, &file}) {
    for (const char* name : {"path", "model", "file"}) summary->erase(name);
  }
  EXPECT_EQ(remote, file);
  const auto model = model::ModelFile::open(local());
  EXPECT_LE(4 * server_.requests().size(), model->blocks().size());
}

TEST_F(StoredModelTest, WhatPassesChangesNoPixel) {
  const std::string expected = picture_of(local());
  for (const Fault fault : {Fault::kBusy, Fault::kCut, Fault::kHanging, Fault::kStalling}) {
    server_.fail(fault, 2, /*after=*/2);
    const client::ProgramOutcome outcome = draw(server_.url(kPath));
    ASSERT_EQ(outcome.code, 0) << static_cast<int>(fault) << outcome.output;
    EXPECT_TRUE(content(picture()) == expected) << static_cast<int>(fault);
  }
}

TEST_F(StoredModelTest, WhatDoesNotPassIsOneLineInTimeAndNoPicture) {
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(draw(local()).code, 0);
  const auto usual = std::chrono::steady_clock::now() - start;
  std::filesystem::remove(picture());
  for (const Fault fault : {Fault::kWholeObject, Fault::kForbidden, Fault::kAbsent, Fault::kNoSuchRange, Fault::kBusy,
                            Fault::kCut, Fault::kHanging, Fault::kStalling, Fault::kWrongBytes, Fault::kWrongRange,
                            Fault::kShiftedRange, Fault::kReplaced}) {
    server_.fail(fault, 1000, /*after=*/2);
    const auto begin = std::chrono::steady_clock::now();
    const client::ProgramOutcome outcome = draw(server_.url(kPath));
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(8) + 2 * usual)
        << "without the flags it would be ten seconds more than usual";
    EXPECT_EQ(outcome.code, 1) << static_cast<int>(fault);
    EXPECT_THAT(outcome.output, HasSubstr("surfcastd: " + server_.url(kPath)));
    EXPECT_FALSE(std::filesystem::exists(picture())) << static_cast<int>(fault);
  }
}

TEST_F(StoredModelTest, AnObjectThatIsReplacedWhileItIsDrawnIsOpenedAnewAndNeverMixed) {
  write(folder_ / "other.surf", true);
  const std::string expected = picture_of((folder_ / "other.surf").string());
  ASSERT_FALSE(expected == picture_of(local()));
  for (const size_t answers : {2U, 3U}) {
    server_.put(kPath, content(local()));
    server_.put_after(answers, kPath, content(folder_ / "other.surf"));
    const client::ProgramOutcome outcome = draw(server_.url(kPath));
    ASSERT_EQ(outcome.code, 0) << outcome.output;
    EXPECT_TRUE(content(picture()) == expected) << answers;
  }
}

TEST_F(StoredModelTest, AKeyOfS3IsDrawnToo) {
  const std::string expected = picture_of(local());
  const client::ProgramOutcome outcome = draw("s3://models/sphere.surf", "--s3-endpoint " + server_.url("/"));
  ASSERT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_TRUE(content(picture()) == expected);
}

TEST_F(StoredModelTest, WhatIsNoModelIsRefused) {
  EXPECT_THAT(draw(server_.url("/models/")).output, HasSubstr("expected one model, got a folder"));
  EXPECT_THAT(draw(server_.url("/models/a.laz")).output, HasSubstr("neither a model"));
  EXPECT_THAT(draw(server_.url("/models/none.surf")).output, HasSubstr("404"));
}

}  // namespace
}  // namespace surfcast::object_store
