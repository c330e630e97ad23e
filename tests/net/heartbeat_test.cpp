#include "net/heartbeat.h"

#include <gtest/gtest.h>

namespace surfcast::net {
namespace {

using std::chrono::milliseconds;
using Step = Heartbeat::Step;

/// Times are milliseconds since the connection began; a client may be silent for 100.
class HeartbeatTest : public ::testing::Test {
 protected:
  Step poll(int at) { return heartbeat_.poll(Heartbeat::Clock::time_point(milliseconds(at))); }
  void hear(int at) { heartbeat_.hear(Heartbeat::Clock::time_point(milliseconds(at))); }

  Heartbeat heartbeat_{milliseconds(100), Heartbeat::Clock::time_point{}};
};

TEST_F(HeartbeatTest, ASilentClientIsAskedOnceAndThenGone) {
  EXPECT_EQ(poll(99), Step::kWait);
  EXPECT_EQ(poll(100), Step::kAsk);
  EXPECT_EQ(poll(110), Step::kWait);
  EXPECT_EQ(poll(199), Step::kWait);
  EXPECT_EQ(poll(200), Step::kGone);
}

TEST_F(HeartbeatTest, AnAnswerBeginsTheWaitAnew) {
  EXPECT_EQ(poll(100), Step::kAsk);
  hear(150);
  EXPECT_EQ(poll(249), Step::kWait);
  EXPECT_EQ(poll(250), Step::kAsk);
}

TEST_F(HeartbeatTest, AClientThatTalksIsNotAsked) {
  for (int at = 50; at < 1000; at += 50) {
    hear(at);
    EXPECT_EQ(poll(at + 49), Step::kWait);
  }
}

TEST_F(HeartbeatTest, NobodyIsGoneWithoutHavingBeenAsked) {
  EXPECT_EQ(poll(5000), Step::kAsk);
  EXPECT_EQ(poll(5099), Step::kWait);
  EXPECT_EQ(poll(5100), Step::kGone);
}

}  // namespace
}  // namespace surfcast::net
