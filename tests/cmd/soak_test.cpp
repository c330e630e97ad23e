#include "cmd/serve_fixture.h"

namespace surfcast::cmd {
namespace {

/// A minute of what bench/soak does for a quarter of an hour: clients come and go in the middle of movements, rests and
/// pictures. In so short a time caches still settle, hence 5 % of memory.
TEST_F(ServeTest, AMinuteOfComingAndGoingLeavesNothingBehind) {
  serve(scan_.string());
  const client::ProgramOutcome outcome =
      client::run_program(SURFCAST_SOAK " " + std::to_string(server_) + " " + url_ + "/square 60 3 5");
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_EQ(end(SIGTERM), 0);
}

}  // namespace
}  // namespace surfcast::cmd
