#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/run_program.h"
#include "model/test_folder.h"
#include "object_store/hills.h"
#include "object_store/range_server.h"
#include "support/path_of.h"

namespace surfcast::object_store {
namespace {

using testing::Fault;
using ::testing::HasSubstr;
using testing::RangeServer;

namespace fs = std::filesystem;

constexpr const char* kCopc = "/scans/hills.copc.laz";
constexpr const char* kEptFolder = "/scans/hills/";
constexpr const char* kCoarse = "--spacing 8";  // of few blocks

std::string file_content(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The program itself shows scans in place that a server holds, which fails as it is told.
class InPlaceStoreTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ::setenv("no_proxy", "127.0.0.1", 1);
    write_scan("hills", 0);
    server_.put(kCopc, file_content(file("hills.copc.laz")));
  }

  /// A coloured surface as COPC and EPT; `turn`: of its colours.
  void write_scan(const std::string& name, int turn) const {
    std::ofstream(file(name + ".ply")) << testing::hills(250, turn);
    for (const char* target : {".copc.laz", "/ept.json"}) {
      ASSERT_EQ(client::run_program(path_of("surfcastd") + " export " + file(name + ".ply") +
                                    " --chunk 2000 --output " + file(name + target) + " 2>&1")
                    .code,
                0);
    }
  }

  /// The files of an EPT folder but its description, by their places in the store.
  [[nodiscard]] std::map<std::string, std::string> tiles(const std::string& name) const {
    std::map<std::string, std::string> contents;
    for (const auto& entry : fs::recursive_directory_iterator(file(name))) {
      if (!entry.is_regular_file() || entry.path().filename() == "ept.json") continue;
      contents[kEptFolder + fs::relative(entry.path(), file(name)).string()] = file_content(entry.path());
    }
    return contents;
  }

  /// Puts all files of an EPT folder into the store. Returns the URL of its description.
  [[nodiscard]] std::string put_ept() {
    for (const auto& [path, content] : tiles("hills")) server_.put_page(path, content);
    server_.put(kEptFolder + std::string("ept.json"), file_content(file("hills/ept.json")));
    return server_.url(kEptFolder + std::string("ept.json"));
  }

  [[nodiscard]] client::ProgramOutcome draw(const std::string& scan, const std::string& flags = {}) const {
    fs::remove(picture());
    return client::run_program(path_of("surfcastd") + " render " + scan + " --in-place --resolution 160,120 --output " +
                               picture() + " --store-timeout 3 --store-stall-timeout 0.3 " + flags +
                               " 2>&1 >/dev/null");
  }
  [[nodiscard]] std::string drawn(const std::string& scan, const std::string& flags = {}) const {
    const client::ProgramOutcome outcome = draw(scan, flags);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    return file_content(picture());
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name.c_str()).string(); }
  [[nodiscard]] std::string picture() const { return file("picture.png"); }

  model::TestFolder folder_;
  RangeServer server_;
};

TEST_F(InPlaceStoreTest, AUrlIsShownLikeTheFileAndOnlyWhatAPictureNeedsIsFetched) {
  const std::string expected = drawn(file("hills.copc.laz"));
  EXPECT_TRUE(drawn(server_.url(kCopc)) == expected);
  server_.forget_requests();
  const uint64_t before = server_.bytes();
  EXPECT_FALSE(drawn(server_.url(kCopc), "--spacing 8").empty());
  EXPECT_LT(server_.bytes() - before, fs::file_size(file("hills.copc.laz")) / 2);
}

TEST_F(InPlaceStoreTest, AFolderOfEptIsShownLikeOneOfThisMachine) {
  const std::string expected = drawn(file("hills"));
  EXPECT_TRUE(drawn(put_ept()) == expected);
}

TEST_F(InPlaceStoreTest, BlocksOnDiskAreNotMadeAgainAndShowTheSame) {
  const std::string cache = "--block-cache 64M --cache " + file("cache");
  const std::string first = drawn(server_.url(kCopc), cache);
  const uint64_t before = server_.bytes();
  EXPECT_TRUE(drawn(server_.url(kCopc), cache) == first);
  EXPECT_LT(server_.bytes() - before, before / 2) << "the head, the hierarchy and the root";
}

TEST_F(InPlaceStoreTest, InspectPickAndExportTakeUrls) {
  const client::ProgramOutcome inspected = client::run_program(path_of("surfcastd") + " inspect " + server_.url(kCopc));
  EXPECT_THAT(inspected.output, HasSubstr("in place"));
  EXPECT_THAT(inspected.output, HasSubstr("surfels: 62500"));
  const client::ProgramOutcome picked = client::run_program(path_of("surfcastd") + " pick " + server_.url(kCopc) +
                                                            " --resolution 160,120 --pixel 80,60 2>&1");
  EXPECT_EQ(picked.code, 0) << picked.output;
  const client::ProgramOutcome exported = client::run_program(path_of("surfcastd") + " export " + server_.url(kCopc) +
                                                              " --output " + file("out.csv") + " 2>&1");
  EXPECT_THAT(exported.output, HasSubstr("62500 points"));
}

TEST_F(InPlaceStoreTest, WhatPassesChangesNoPixel) {
  for (const auto& [url, scan] :
       std::map<std::string, std::string>{{server_.url(kCopc), file("hills.copc.laz")}, {put_ept(), file("hills")}}) {
    const std::string expected = drawn(scan);
    for (const Fault fault : {Fault::kBusy, Fault::kCut, Fault::kHanging, Fault::kStalling}) {
      server_.fail(fault, 2, /*after=*/2);
      EXPECT_TRUE(drawn(url) == expected) << url << ' ' << static_cast<int>(fault);
    }
  }
}

TEST_F(InPlaceStoreTest, AFaultOfAnyOneAnswerIsAnErrorInTimeOrChangesNoPixel) {
  for (const std::string& url : {server_.url(kCopc), put_ept()}) {
    server_.forget_requests();
    const auto start = std::chrono::steady_clock::now();
    const std::string expected = drawn(url, kCoarse);
    const auto usual = std::chrono::steady_clock::now() - start;
    const size_t answers = server_.requests().size();
    ASSERT_GE(answers, 3U);
    for (const Fault fault : {Fault::kAbsent, Fault::kForbidden, Fault::kReplaced, Fault::kBusy, Fault::kCut,
                              Fault::kHanging, Fault::kStalling}) {
      for (size_t answer = 0; answer < answers; ++answer) {
        server_.fail(fault, 1, answer);
        const auto begin = std::chrono::steady_clock::now();
        const client::ProgramOutcome outcome = draw(url, kCoarse);
        EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(8) + 2 * usual);
        const std::string what = url + ", fault " + std::to_string(static_cast<int>(fault)) + " of answer " +
                                 std::to_string(answer) + ": " + outcome.output;
        if (outcome.code == 0) {
          EXPECT_TRUE(file_content(picture()) == expected) << what;
        } else {
          EXPECT_THAT(outcome.output, HasSubstr("surfcastd: " + url)) << what;
          EXPECT_FALSE(fs::exists(picture())) << what;
        }
      }
    }
  }
}

TEST_F(InPlaceStoreTest, WhatDoesNotPassIsOneLineInTimeAndNoPicture) {
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(draw(file("hills.copc.laz")).code, 0);
  const auto usual = std::chrono::steady_clock::now() - start;
  const auto expect_error = [&](const std::string& url, Fault fault) {
    server_.fail(fault, 1000, /*after=*/2);
    const auto begin = std::chrono::steady_clock::now();
    const client::ProgramOutcome outcome = draw(url);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(8) + 2 * usual)
        << "without the flags it would be ten seconds more than usual";
    EXPECT_EQ(outcome.code, 1) << static_cast<int>(fault);
    EXPECT_THAT(outcome.output, HasSubstr("surfcastd: " + url));
    EXPECT_FALSE(fs::exists(picture())) << url << ' ' << static_cast<int>(fault);
  };
  for (const Fault fault :
       {Fault::kWholeObject, Fault::kForbidden, Fault::kAbsent, Fault::kNoSuchRange, Fault::kBusy, Fault::kCut,
        Fault::kHanging, Fault::kStalling, Fault::kWrongRange, Fault::kShiftedRange, Fault::kReplaced}) {
    expect_error(server_.url(kCopc), fault);
  }
  const std::string ept = put_ept();
  for (const Fault fault : {Fault::kForbidden, Fault::kAbsent, Fault::kBusy, Fault::kCut, Fault::kHanging,
                            Fault::kStalling, Fault::kReplaced}) {
    expect_error(ept, fault);
  }
}

TEST_F(InPlaceStoreTest, AScanThatIsReplacedWhileItIsDrawnIsOpenedAnewAndNeverMixed) {
  write_scan("other", 100);
  const std::string other = file_content(file("other.copc.laz"));
  const std::string expected = drawn(file("other.copc.laz"));
  ASSERT_FALSE(expected == drawn(file("hills.copc.laz")));
  for (const size_t answers : {1U, 2U, 3U}) {  // before the hierarchy, the root, and other nodes
    server_.put(kCopc, file_content(file("hills.copc.laz")));
    server_.put_after(answers, kCopc, other);
    EXPECT_TRUE(drawn(server_.url(kCopc)) == expected) << answers;
  }
}

TEST_F(InPlaceStoreTest, TilesThatAreReplacedWhileTheyAreDrawnAreNeverMixed) {
  write_scan("other", 100);
  const std::string url = put_ept();
  const std::string former = drawn(url);
  const std::string expected = drawn(file("other"));
  ASSERT_FALSE(expected == former);
  for (const size_t answers : {1U, 2U, 3U, 4U}) {  // after the description, the hierarchy, the root, another tile
    ASSERT_EQ(put_ept(), url);
    server_.put_pages_after(answers, tiles("other"));
    EXPECT_TRUE(drawn(url) == expected) << answers;
  }
}

TEST_F(InPlaceStoreTest, AHierarchyThatACacheKeptDoesNotMakeOldTilesNewer) {
  const std::string url = put_ept();
  const std::string expected = drawn(url);
  // The cache answers with the date when it got the page, an hour before the tiles were written, and how long ago.
  server_.set_page_headers("Date: Fri, 15 Jan 2027 07:00:00 GMT\r\nAge: 3600\r\n");
  EXPECT_TRUE(drawn(url) == expected);
}

}  // namespace
}  // namespace surfcast::object_store
