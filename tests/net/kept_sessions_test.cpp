#include "net/kept_sessions.h"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::net {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const KeptSessions::Clock::time_point kStart{};

std::vector<KeptView> a_view(size_t bytes = 10) {
  return {{.id = 7, .picture = std::string(bytes, 'p'), .update = 3, .target_fps = 20}};
}

TEST(KeptSessionsTest, ASessionWaitsForItsClientForThreeMinutes) {
  for (const int wait : {1, 60, 170, 180, 181}) {
    KeptSessions sessions({});
    const std::string secret = sessions.begin({}, "alice", "10.0.0.1");
    sessions.keep(secret, a_view(), kStart);
    EXPECT_EQ(sessions.waiting(kStart + seconds(wait)), wait <= 180 ? 1U : 0U) << wait;
    EXPECT_EQ(sessions.take(secret, "alice", kStart + seconds(wait)).size(), wait <= 180 ? 1U : 0U) << wait;
    EXPECT_TRUE(sessions.take(secret, "alice", kStart + seconds(wait)).empty()) << "a second time";
  }
}

TEST(KeptSessionsTest, NobodyElseGoesOnWithASession) {
  KeptSessions sessions({});
  const std::string secret = sessions.begin({}, "alice", "10.0.0.1");
  sessions.keep(secret, a_view(), kStart);
  EXPECT_TRUE(sessions.take(secret, "bob", kStart).empty());
  EXPECT_TRUE(sessions.take("", "alice", kStart).empty());
  const std::vector<KeptView> views = sessions.take(secret, "alice", kStart);
  ASSERT_EQ(views.size(), 1U);
  EXPECT_EQ(views[0].id, 7U);
  EXPECT_EQ(views[0].update, 3U);
}

TEST(KeptSessionsTest, AViewOfMoreThanEightKibibytesDoesNotWait) {
  KeptSessions sessions({});
  const std::string secret = sessions.begin({}, "", "10.0.0.1");
  sessions.keep(secret, a_view(8192), kStart);
  EXPECT_EQ(sessions.waiting(kStart), 0U);
}

TEST(KeptSessionsTest, WhoLeavesManySessionsBehindLosesItsOwn) {
  KeptSessions sessions({.sessions = 4});
  const std::string other = sessions.begin({}, "", "10.0.0.1");
  sessions.keep(other, a_view(), kStart);
  std::string last;
  for (int i = 0; i < 100; ++i) {
    last = sessions.begin({}, "", "10.0.0.2");
    sessions.keep(last, a_view(), kStart + milliseconds(i));
  }
  EXPECT_EQ(sessions.waiting(kStart), 4U);
  EXPECT_EQ(sessions.take(other, "", kStart).size(), 1U);
  EXPECT_EQ(sessions.take(last, "", kStart).size(), 1U);
}

TEST(KeptSessionsTest, AConnectionThatSeemsAliveHandsItsViewsOver) {
  struct Alive : KeptSessions::Holder {
    std::vector<KeptView> hand_over() override { return a_view(); }
  };
  KeptSessions sessions({});
  const auto alive = std::make_shared<Alive>();
  const std::string secret = sessions.begin(alive, "", "10.0.0.1");
  EXPECT_EQ(sessions.take(secret, "", kStart).size(), 1U);
}

TEST(KeptSessionsTest, WhereNoneMayWaitNoneBegins) {
  KeptSessions sessions({.sessions = 0});
  EXPECT_EQ(sessions.begin({}, "", "10.0.0.1"), "");
}

}  // namespace
}  // namespace surfcast::net
