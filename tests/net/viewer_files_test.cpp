#include <filesystem>
#include <fstream>

#include "net/net_fixture.h"
#include "net/static_files.h"

namespace surfcast::net {
namespace {

namespace fs = std::filesystem;

/// A folder as the viewer's build leaves it, with traps.
class ViewerFilesTest : public NetFixture {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("viewer_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "dist/assets");
    write("secret.txt", "secret");
    write("dist/index.html", "<!DOCTYPE html>");
    write("dist/assets/main-1a2b.js", "let x = 1;");
    write("dist/.hidden", "hidden");
    fs::create_symlink(folder_ / "secret.txt", folder_ / "dist/link.txt");
    fs::create_directory_symlink(folder_, folder_ / "dist/up");
  }
  void TearDown() override {
    stop();
    fs::remove_all(folder_);
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  void start_with_viewer() {
    auto files = StaticFiles::read(folder_ / "dist");
    ASSERT_TRUE(files);
    ServerConfig config;
    config.viewer = std::make_shared<const StaticFiles>(std::move(*files));
    start(config);
  }

  fs::path folder_;
};

bool has(const std::string& answer, const std::string& line) {
  return answer.find("\r\n" + line + "\r\n") != std::string::npos;
}

TEST_F(ViewerFilesTest, ThePageIsAskedForAgainAndGuarded) {
  start_with_viewer();
  const std::string answer = get("/?from=link");
  EXPECT_TRUE(answer.ends_with("\r\n\r\n<!DOCTYPE html>"));
  EXPECT_TRUE(has(answer, "Content-Type: text/html; charset=utf-8"));
  EXPECT_TRUE(has(answer, "Cache-Control: no-cache"));
  EXPECT_NE(answer.find("Content-Security-Policy: default-src 'self'"), std::string::npos);
  EXPECT_EQ(get("/index.html").substr(9, 3), "200");
}

TEST_F(ViewerFilesTest, AssetsMayBeKept) {
  start_with_viewer();
  const std::string answer = get("/assets/main-1a2b.js");
  EXPECT_TRUE(answer.ends_with("let x = 1;"));
  EXPECT_TRUE(has(answer, "Content-Type: text/javascript; charset=utf-8"));
  EXPECT_TRUE(has(answer, "Cache-Control: public, max-age=31536000, immutable"));
}

TEST_F(ViewerFilesTest, AnUnchangedFileIsNotSentAgain) {
  start_with_viewer();
  const std::string answer = get("/");
  const size_t place = answer.find("ETag: ") + 6;
  const std::string tag = answer.substr(place, answer.find("\r\n", place) - place);
  const auto ask = [this](const std::string& header) {
    return http("GET / HTTP/1.1\r\nHost: here\r\n" + header + "\r\nConnection: close\r\n\r\n");
  };
  const std::string again = ask("If-None-Match: " + tag);
  EXPECT_EQ(again.substr(9, 3), "304");
  EXPECT_TRUE(again.ends_with("\r\n\r\n"));
  EXPECT_EQ(ask("If-None-Match: \"0123456789abcdef\"").substr(9, 3), "200");
}

TEST_F(ViewerFilesTest, NothingOutsideTheFolderIsReached) {
  start_with_viewer();
  for (const char* target : {"/../secret.txt", "/assets/../../secret.txt", "/%2e%2e/secret.txt", "/link.txt",
                             "/up/secret.txt", "/.hidden", "//index.html", "/assets", "/assets/"}) {
    EXPECT_EQ(get(target).substr(9, 3), "404") << target;
  }
}

TEST_F(ViewerFilesTest, FilesAreOnlyRead) {
  start_with_viewer();
  EXPECT_EQ(http("PUT /index.html HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n").substr(9, 3), "405");
}

TEST_F(ViewerFilesTest, WhatTheServerAnswersItselfIsNotHidden) {
  start_with_viewer();
  EXPECT_EQ(get("/api/models").substr(9, 3), "200");
  EXPECT_EQ(get("/healthz").substr(9, 3), "200");
}

TEST_F(ViewerFilesTest, AFolderWithoutAPageIsNoViewer) {
  fs::remove(folder_ / "dist/index.html");
  EXPECT_FALSE(StaticFiles::read(folder_ / "dist"));
  EXPECT_FALSE(StaticFiles::read(folder_ / "absent"));
}

TEST_F(ViewerFilesTest, AFolderLargerThanAViewerIsRefused) {
  fs::resize_file(folder_ / "dist/index.html", uintmax_t{65} << 20);
  EXPECT_FALSE(StaticFiles::read(folder_ / "dist"));
  EXPECT_TRUE(StaticFiles::read(folder_ / "dist", {.bytes = uintmax_t{70} << 20}));
  EXPECT_FALSE(StaticFiles::read(folder_ / "dist", {.files = 1, .bytes = uintmax_t{70} << 20}));
}

}  // namespace
}  // namespace surfcast::net
