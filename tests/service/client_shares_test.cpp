#include "service/client_shares.h"

#include <gtest/gtest.h>

namespace surfcast::service {
namespace {

TEST(ClientSharesTest, WhatIsSpentOnAClientCountsWhileAnybodyHasJobs) {
  ClientShares shares;
  shares.enter(1);
  shares.enter(2);
  shares.charge(1, 30);
  EXPECT_EQ(shares.used(1), 30);
  EXPECT_EQ(shares.used(2), 0);
  shares.leave(1);
  EXPECT_EQ(shares.used(1), 30) << "it was ahead, and still is when it comes back at once";
  shares.leave(2);
  EXPECT_EQ(shares.used(1), 0) << "nobody waits for it any more";
}

TEST(ClientSharesTest, AClientIsNotOwedTheTimeThatItWasAway) {
  ClientShares shares;
  shares.enter(1);
  shares.charge(1, 500);
  shares.enter(2);
  EXPECT_EQ(shares.used(2), 500);
  shares.charge(1, 100);
  shares.leave(2);
  shares.enter(2);
  EXPECT_EQ(shares.used(2), 600);
}

TEST(ClientSharesTest, AClientThatComesAndGoesKeepsWhatWasSpentOnIt) {
  ClientShares shares;
  shares.enter(1);
  for (int i = 0; i < 10; ++i) {
    shares.enter(2);
    shares.charge(2, 10);
    shares.leave(2);
  }
  EXPECT_EQ(shares.used(2), 100);
}

}  // namespace
}  // namespace surfcast::service
