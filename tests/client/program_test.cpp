#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "client/run_program.h"
#include "net/net_fixture.h"
#include "support/path_of.h"

namespace surfcast::client {
namespace {

namespace fs = std::filesystem;

/// The program itself against a server of fake models.
class ProgramTest : public net::NetFixture {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("program_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    start();
  }
  void TearDown() override {
    stop();
    fs::remove_all(folder_);
  }

  /// Standard error becomes part of the output.
  [[nodiscard]] static ProgramOutcome run(const std::string& arguments) {
    return run_program(path_of("surfcast") + " " + arguments + " 2>&1");
  }
  [[nodiscard]] std::string url() const { return protocol::to_string(endpoint()); }
  [[nodiscard]] size_t entries() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  static std::string content(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }

  fs::path folder_;
};

TEST_F(ProgramTest, ModelsAreListed) {
  const ProgramOutcome outcome = run("models " + url());
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.output, "cube\nteapot\n");
}

TEST_F(ProgramTest, ModelsAreListedByWebSocket) {
  const ProgramOutcome outcome = run("models ws://" + url());
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.output, "cube\nteapot\n");
}

TEST_F(ProgramTest, ModelsAreListedAsJson) {
  const ProgramOutcome outcome = run("models tcp://" + url() + " --json");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.output.find("\"teapot\""), std::string::npos);
}

TEST_F(ProgramTest, PingMeasuresRoundTrips) {
  const ProgramOutcome outcome = run("ping --count 3 " + url());
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.output.find("3 round trips"), std::string::npos);
}

TEST_F(ProgramTest, ARenderWritesThePictureAndItsFigures) {
  const fs::path picture = folder_ / "out.png";
  const fs::path stats = folder_ / "out.json";
  const ProgramOutcome outcome =
      run("render " + url() + "/cube --resolution 12,7 --output " + picture.string() + " --stats " + stats.string());
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_EQ(outcome.output, "");
  EXPECT_EQ(content(picture).substr(1, 3), "PNG");
  EXPECT_NE(content(stats).find("\"surfels_drawn\": 99"), std::string::npos);
  EXPECT_EQ(entries(), 2u);
}

TEST_F(ProgramTest, ARenderGoesToStandardOutput) {
  const ProgramOutcome outcome = run("render " + url() + "/cube --resolution 12,7 --output - --format jpg");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.output.substr(0, 2), "\xff\xd8");
}

TEST_F(ProgramTest, TheSameRequestGivesTheSameBytes) {
  const std::string line = "render " + url() + "/cube --resolution 64,64 --background 1,2,3 --output - --format ";
  for (const std::string format : {"png", "jpg", "webp", "exr"}) {
    EXPECT_EQ(run(line + format).output, run(line + format).output) << format;
  }
}

TEST_F(ProgramTest, FailuresAreOneLineAndLeaveNothingBehind) {
  const std::string out = (folder_ / "out.png").string();
  for (const std::string& arguments :
       {"render " + url() + "/absent --output " + out,
        "render " + url() + "/cube --resolution 9000,9000 --output " + out, "render 127.0.0.1:1/cube --output " + out,
        "render no.such.host.invalid:7600/cube --output " + out,
        "render " + url() + "/cube --output " + (folder_ / "absent" / "out.png").string(),
        "render " + url() + "/cube --camera " + (folder_ / "absent.json").string() + " --output " + out,
        std::string("models 127.0.0.1:1"), std::string("ping 127.0.0.1:1")}) {
    const ProgramOutcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 1) << arguments;
    EXPECT_EQ(outcome.output.find("surfcast: "), 0u) << outcome.output;
    EXPECT_EQ(outcome.output.find('\n'), outcome.output.size() - 1) << outcome.output;
  }
  EXPECT_EQ(entries(), 0u);
}

TEST_F(ProgramTest, WrongCommandLinesEndWithTwo) {
  for (const std::string& arguments :
       {std::string(), std::string("fly"), std::string("models"), std::string("models nowhere"),
        "render " + url() + " --output a.png", "render " + url() + "/cube", "render " + url() + "/cube --output a.gif",
        "render " + url() + "/cube --output -", "render " + url() + "/cube --output a.png --resolution 5",
        "render " + url() + "/cube --output a.png --camera-position 1,2,3", "ping " + url() + " --count 0"}) {
    const ProgramOutcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_EQ(outcome.output.find("surfcast: "), 0u) << outcome.output;
  }
  EXPECT_FALSE(fs::exists("a.png"));
}

TEST_F(ProgramTest, HelpAndVersionEndWithZero) {
  EXPECT_EQ(run("--help").code, 0);
  EXPECT_EQ(run("render --help").code, 0);
  EXPECT_EQ(run("--version").code, 0);
}

TEST_F(ProgramTest, AnInterruptGivesThePictureUpAtTheServer) {
  control_->slow = true;
  const pid_t client =
      start_program({path_of("surfcast"), "render", url() + "/cube", "--output", (folder_ / "out.png").string()});
  ASSERT_TRUE(eventually([&] { return control_->drawn == 1; }));
  ASSERT_EQ(::kill(client, SIGINT), 0);
  EXPECT_EQ(wait_for_program(client), 1);
  EXPECT_TRUE(eventually([&] { return control_->cancelled == 1; }));
  EXPECT_EQ(entries(), 0u);
}

TEST_F(ProgramTest, APathIsDrawnFrameByFrame) {
  std::ofstream(folder_ / "path.json") << R"({"keyframes": [
      {"time": 0, "position": [0, 0, 9], "focal_point": [0, 0, 0]},
      {"time": 0.2, "position": [0, 9, 0], "focal_point": [0, 0, 0]}]})";
  const std::string frames = " --path " + (folder_ / "path.json").string() + " --fps 10 --resolution 8,8 --output ";
  const ProgramOutcome outcome = run("render " + url() + "/cube" + frames + (folder_ / "f_%03d.png").string());
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_EQ(entries(), 4u);
  EXPECT_TRUE(fs::exists(folder_ / "f_000.png") && fs::exists(folder_ / "f_002.png"));
  EXPECT_EQ(run("render " + url() + "/cube" + frames + (folder_ / "one.png").string()).code, 2);
  EXPECT_EQ(run("render " + url() + "/cube --path nowhere.json --output f_%d.png").code, 1);
}

TEST_F(ProgramTest, APickAnswersOrSaysWhyNot) {
  EXPECT_EQ(run("pick " + url() + "/cube").code, 2);
  const ProgramOutcome missing = run("pick " + url() + "/cube --pixel 1,2");
  EXPECT_EQ(missing.code, 1);
  EXPECT_NE(missing.output.find("there is no file of this model"), std::string::npos) << missing.output;
}

}  // namespace
}  // namespace surfcast::client
