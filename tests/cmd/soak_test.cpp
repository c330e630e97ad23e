#include "cmd/serve_fixture.h"
#include "support/path_of.h"
#include "support/sample_size.h"

namespace surfcast::cmd {
namespace {

/// A quarter of a minute of what bench/soak does for a quarter of an hour, or SURFCAST_SOAK_SECONDS: clients come and
/// go in the middle of movements, rests and pictures. In so short a time caches still settle, hence 8 % of memory.
TEST_F(ServeTest, ComingAndGoingLeavesNothingBehind) {
  serve(scan_.string());
  const int seconds = testing::sample_size("SURFCAST_SOAK_SECONDS", 15);
  const std::string command = path_of("soak") + " " + std::to_string(server_) + " " + url_ + "/square " +
                              std::to_string(seconds) + " 3 " + (seconds < 60 ? "8" : "5");
  const client::ProgramOutcome outcome = client::run_program(command);
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_EQ(end(SIGTERM), 0);
}

}  // namespace
}  // namespace surfcast::cmd
