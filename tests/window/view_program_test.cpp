#include <csignal>
#include <cstdlib>

#include "client/run_program.h"
#include "net/net_fixture.h"
#include "support/path_of.h"

namespace surfcast::window {
namespace {

/// `surfcast view` without a display, against a server of fake models.
class ViewProgramTest : public net::NetFixture {
 protected:
  void SetUp() override { ::setenv("SDL_VIDEODRIVER", "dummy", 1); }
  [[nodiscard]] std::string url(const std::string& model) const {
    return protocol::to_string(endpoint()) + "/" + model;
  }
};

TEST_F(ViewProgramTest, ShowsAModelUntilItIsToldToEnd) {
  start();
  const pid_t program =
      client::start_program({path_of("surfcast"), "view", "ws://" + url("cube"), "--resolution", "64,48"});
  EXPECT_TRUE(eventually([this] { return metric("surfcast_view_frames_total") > 0; }));
  ::kill(program, SIGTERM);
  EXPECT_EQ(client::wait_for_program(program), 0);
}

TEST_F(ViewProgramTest, ComesBackToAServerThatComesBack) {
  start();
  const uint16_t port = port_;
  const pid_t program = client::start_program({path_of("surfcast"), "view", url("cube"), "--resolution", "64,48"});
  EXPECT_TRUE(eventually([this] { return metric("surfcast_view_frames_total") > 2; })) << "it has painted one";
  stop();
  start({}, {}, port);
  EXPECT_TRUE(eventually([this] { return metric("surfcast_view_frames_total") > 0; }));
  ::kill(program, SIGTERM);
  EXPECT_EQ(client::wait_for_program(program), 0);
}

TEST_F(ViewProgramTest, AModelThatIsNotThereIsAFailure) {
  start();
  const client::ProgramOutcome outcome = client::run_program(path_of("surfcast") + " view " + url("nowhere") + " 2>&1");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.output.find("no such model"), std::string::npos);
}

TEST_F(ViewProgramTest, AWrongCommandLineEndsWithTwo) {
  EXPECT_EQ(client::run_program(path_of("surfcast") + " view 2>/dev/null").code, 2);
  EXPECT_EQ(client::run_program(path_of("surfcast") + " view here:1/cube --resolution wide 2>/dev/null").code, 2);
  EXPECT_EQ(client::run_program(path_of("surfcast") + " view --help").code, 0);
}

}  // namespace
}  // namespace surfcast::window
