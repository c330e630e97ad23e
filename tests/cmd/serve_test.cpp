#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "client/run_program.h"

namespace surfcast {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// A coloured square of points in the plane z = 0.
std::string square_of_points() {
  std::ostringstream ply;
  ply << "ply\nformat ascii 1.0\nelement vertex 400\nproperty float x\nproperty float y\nproperty float z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  for (int i = 0; i < 400; ++i) ply << i % 20 << ' ' << i / 20 << " 0 200 100 50\n";
  return ply.str();
}

/// The programs themselves: a server of one scan, and what is asked of it.
class ServeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("serve_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    scan_ = folder_ / "square.ply";
    ASSERT_TRUE(write_file_atomically(scan_, square_of_points()));
  }
  void TearDown() override {
    if (server_ > 0) end(SIGKILL);
    fs::remove_all(folder_);
  }

  /// Starts a server and waits until it says that it is ready.
  void serve(const std::string& arguments) {
    const std::string ready = (folder_ / "ready").string();
    fs::remove(ready);  // of a server before this one
    server_ = start_program({"/bin/sh", "-c",
                             "exec " SURFCAST_SERVER " serve --listen 127.0.0.1:0 --cache " + cache() + " " +
                                 arguments + " > " + ready + " 2> " + (folder_ / "log").string()});
    for (int i = 0; i < 3000 && content(ready).find('\n') == std::string::npos; ++i) ::usleep(10'000);
    const std::string line = content(ready);
    const size_t url = line.find("http://");
    ASSERT_NE(url, std::string::npos) << line << content(folder_ / "log");
    url_ = line.substr(url + 7, line.find('/', url + 7) - url - 7);
  }
  int end(int signal) {
    ::kill(server_, signal);
    const int code = wait_for_program(server_);
    server_ = -1;
    return code;
  }
  [[nodiscard]] std::string cache() const { return (folder_ / "cache").string(); }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }

  fs::path folder_;
  fs::path scan_;
  pid_t server_ = -1;
  std::string url_;
};

TEST_F(ServeTest, AScanIsBuiltServedDrawnAndTheServerEndsWhenTold) {
  serve(scan_.string());
  EXPECT_EQ(run_program(SURFCAST_CLIENT " models " + url_).output, "square\n");
  EXPECT_EQ(run_program(SURFCAST_SERVER " healthcheck --url " + url_).code, 0);
  const std::string flags = " --resolution 64,48 --output ";
  ASSERT_EQ(run_program(SURFCAST_CLIENT " render " + url_ + "/square" + flags + file("served.png")).code, 0);
  ASSERT_EQ(run_program(SURFCAST_SERVER " render --cache " + cache() + " " + scan_.string() + flags +
                        file("drawn.png") + " --stats " + file("drawn.json") + " 2>&1")
                .code,
            0);
  EXPECT_FALSE(content(file("served.png")).empty());
  EXPECT_TRUE(content(file("served.png")) == content(file("drawn.png")));
  EXPECT_NE(content(file("drawn.json")).find("\"gl_renderer\""), std::string::npos);
  EXPECT_NE(content(file("log")).find("OpenGL"), std::string::npos);
  EXPECT_EQ(end(SIGTERM), 0);
  EXPECT_EQ(run_program(SURFCAST_SERVER " healthcheck --url " + url_ + " 2>&1").code, 1);
}

TEST_F(ServeTest, AScanIsBuiltOnceHoweverItIsNamed) {
  serve(scan_.string());
  EXPECT_EQ(end(SIGINT), 0);
  const fs::path copy = folder_ / "renamed.ply";
  fs::copy_file(scan_, copy);
  serve(copy.string());
  EXPECT_EQ(run_program(SURFCAST_CLIENT " models " + url_).output, "renamed\n");
  EXPECT_EQ(content(file("log")).find("building"), std::string::npos);
  EXPECT_EQ(std::distance(fs::directory_iterator(cache()), fs::directory_iterator()), 1);
}

TEST_F(ServeTest, WhatCannotBeServedIsAFailureThatNamesIt) {
  ASSERT_TRUE(write_file_atomically(folder_ / "broken.ply", "ply\nformat ascii 1.0\n"));
  for (const std::string name : {"absent.surf", "absent.ply", "broken.ply"}) {
    const ProgramOutcome outcome =
        run_program(SURFCAST_SERVER " serve --listen 127.0.0.1:0 --cache " + cache() + " " + file(name) + " 2>&1");
    EXPECT_EQ(outcome.code, 1) << name;
    EXPECT_NE(outcome.output.find("surfcastd: "), std::string::npos);
    EXPECT_NE(outcome.output.find(name), std::string::npos) << outcome.output;
  }
}

TEST_F(ServeTest, WrongCommandLinesEndWithTwo) {
  for (const std::string arguments : {"serve --listen nowhere", "serve --gpu -1", "render a.surf",
                                      "render a.surf --output a.gif", "healthcheck --url x"}) {
    EXPECT_EQ(run_program(SURFCAST_SERVER " " + arguments + " 2>&1").code, 2) << arguments;
  }
}

}  // namespace
}  // namespace surfcast
