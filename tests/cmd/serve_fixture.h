#pragma once

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "client/run_program.h"
#include "net/raw_socket.h"
#include "support/path_of.h"

namespace surfcast::cmd {

inline std::string content(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// A coloured square of points in the plane z = 0.
inline std::string square_of_points() {
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
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("serve_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    scan_ = folder_ / "square.ply";
    ASSERT_TRUE(write_file_atomically(scan_, square_of_points()));
  }
  void TearDown() override {
    if (server_ > 0) end(SIGKILL);
    std::filesystem::remove_all(folder_);
  }

  /// Starts a server and waits until it says that it is ready.
  void serve(const std::string& arguments) { serve(arguments, file("log")); }
  void serve(const std::string& arguments, const std::string& log) {
    const std::string ready = (folder_ / "ready").string();
    std::filesystem::remove(ready);  // of a server before this one
    server_ =
        client::start_program({"/bin/sh", "-c",
                               "exec " + path_of("surfcastd") + " serve --listen 127.0.0.1:0 --host here --cache " +
                                   cache() + " " + arguments + " > " + ready + " 2> " + log});
    for (int i = 0; i < 3000 && content(ready).find('\n') == std::string::npos; ++i) ::usleep(10'000);
    const std::string line = content(ready);
    const size_t url = line.find("http://");
    ASSERT_NE(url, std::string::npos) << line << content(folder_ / "log");
    url_ = line.substr(url + 7, line.find('/', url + 7) - url - 7);
  }
  /// Draws a small picture of a model, which waits for it.
  /// The limit is that of the whole test: a machine under load draws in software for minutes.
  [[nodiscard]] client::ProgramOutcome draw(const std::string& model) const {
    return client::run_program(path_of("surfcast") + " render " + url_ + "/" + model +
                               " --timeout 290 --resolution 64,48 --output " + file("drawn.png") + " 2>&1");
  }
  [[nodiscard]] ::testing::AssertionResult draws(const std::string& model) const {
    const client::ProgramOutcome outcome = draw(model);
    if (outcome.code == 0) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << outcome.output;
  }
  /// The list of models, once it contains `text`.
  [[nodiscard]] std::string list_until(const std::string& text) const {
    std::string list;
    for (int i = 0; i < 3000 && list.find(text) == std::string::npos; ++i) {
      if (i > 0) ::usleep(20'000);
      list = client::run_program(path_of("surfcast") + " models --json " + url_).output;
    }
    return list;
  }
  int end(int signal) {
    ::kill(server_, signal);
    const int code = client::wait_for_program(server_);
    server_ = -1;
    return code;
  }
  /// The body of the server's answer to a GET.
  [[nodiscard]] std::string get(const std::string& target) const {
    net::RawSocket socket(port());
    socket.send("GET " + target + " HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n");
    const std::string answer = socket.read_to_end(std::chrono::minutes(5));
    return answer.substr(answer.find("\r\n\r\n") + 4);
  }
  [[nodiscard]] uint16_t port() const { return static_cast<uint16_t>(std::stoi(url_.substr(url_.find(':') + 1))); }
  [[nodiscard]] std::string cache() const { return (folder_ / "cache").string(); }
  /// What the cache holds of scans. The shaders of render workers are in a folder of their own.
  [[nodiscard]] std::vector<std::string> cached() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(cache())) {
      if (entry.path().filename() != "shaders") names.push_back(entry.path().filename());
    }
    return names;
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }

  std::filesystem::path folder_;
  std::filesystem::path scan_;
  pid_t server_ = -1;
  std::string url_;
};

}  // namespace surfcast::cmd
