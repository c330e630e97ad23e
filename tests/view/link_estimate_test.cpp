#include "view/link_estimate.h"

#include <algorithm>
#include <deque>
#include <limits>

#include <gtest/gtest.h>

namespace surfcast::view {
namespace {

/// Simulates a connection with a rate and a round-trip time. Messages are delivered in order.
class Line {
 public:
  Line(double bytes_per_ms, double round_trip_ms) : bytes_per_ms_(bytes_per_ms), round_trip_ms_(round_trip_ms) {}

  void send(LinkEstimate& estimate, size_t bytes) {
    estimate.send(++frame_, bytes, at(now_ms_));
    free_ms_ = std::max(free_ms_, now_ms_) + static_cast<double>(bytes) / bytes_per_ms_;
    arrivals_.push_back(free_ms_ + round_trip_ms_);
  }
  /// Acknowledges the oldest message.
  std::optional<double> acknowledge(LinkEstimate& estimate, double client_ms = 0) {
    now_ms_ = std::max(now_ms_, arrivals_.front() + client_ms);
    arrivals_.pop_front();
    return estimate.acknowledge(++acknowledged_, client_ms, at(now_ms_));
  }

  /// Lets time pass until a frame of the next tick would be sent.
  void pass(double ms) { now_ms_ += ms; }
  void set_rate(double bytes_per_ms) { bytes_per_ms_ = bytes_per_ms; }
  [[nodiscard]] ViewTime now() const { return at(now_ms_); }

  /// The next acknowledgement is read so much later than it arrives.
  void wait(double ms) { arrivals_.front() += ms; }

 private:
  static ViewTime at(double ms) {
    return ViewTime{} + std::chrono::duration_cast<ViewTime::duration>(std::chrono::duration<double, std::milli>(ms));
  }
  double bytes_per_ms_;
  double round_trip_ms_;
  double now_ms_ = 1e6;
  double free_ms_ = 0;
  std::deque<double> arrivals_;
  uint64_t frame_ = 0;
  uint64_t acknowledged_ = 0;
};

TEST(LinkEstimate, KnowsNothingAtFirst) {
  const LinkEstimate estimate;
  EXPECT_EQ(estimate.transfer_ms(1'000'000), 0);
  EXPECT_FALSE(estimate.bytes_in(10));
}

TEST(LinkEstimate, OneMessageMakesTheLineTooSlowRatherThanTooFast) {
  LinkEstimate estimate;
  Line line(500, 80);
  line.send(estimate, 20'000);
  line.acknowledge(estimate);
  EXPECT_NEAR(estimate.transfer_ms(20'000), 120, 0.1);
}

TEST(LinkEstimate, MessagesOfTwoSizesTellTheRateFromTheRoundTrip) {
  LinkEstimate estimate;
  Line line(500, 80);
  for (const size_t bytes : {20'000, 8'000, 30'000}) {
    line.send(estimate, bytes);
    line.acknowledge(estimate);
  }
  EXPECT_NEAR(estimate.transfer_ms(50'000), 100, 1);
  EXPECT_NEAR(static_cast<double>(*estimate.bytes_in(100)), 50'000, 500);
}

TEST(LinkEstimate, WhatAMessageWaitsForTheOneBeforeItIsNotItsOwn) {
  LinkEstimate estimate;
  Line line(500, 80);
  for (const size_t bytes : {10'000, 40'000}) {
    line.send(estimate, bytes);
    line.acknowledge(estimate);
  }
  line.send(estimate, 30'000);
  for (int i = 0; i < 50; ++i) {
    line.send(estimate, i % 2 == 0 ? 10'000 : 30'000);
    line.acknowledge(estimate);
  }
  EXPECT_NEAR(estimate.transfer_ms(50'000), 100, 10);
}

TEST(LinkEstimate, TheRoundTripIsKnownWhateverIsOnTheWayTogether) {
  LinkEstimate estimate;
  Line line(500, 150);
  EXPECT_EQ(estimate.round_trip_ms(), 0);
  for (const size_t bytes : {60'000, 5'000}) {
    line.send(estimate, bytes);
    line.acknowledge(estimate);
  }
  line.send(estimate, 5'000);
  for (int i = 0; i < 100; ++i) {
    line.send(estimate, 5'000 + static_cast<size_t>(i) * 37 % 1'500);
    EXPECT_EQ(estimate.bytes_on_the_way() > 10'000, i > 0);
    line.acknowledge(estimate);
  }
  EXPECT_NEAR(estimate.round_trip_ms(), 150, 5);
  EXPECT_NEAR(estimate.transfer_ms(50'000), 100, 10);
}

TEST(LinkEstimate, DelaysOfAllMessagesDoNotCountAsASlowLine) {
  LinkEstimate estimate;
  Line line(2'500, 150);
  for (int i = 0; i < 200; ++i) {
    line.send(estimate, i % 3 == 0 ? 12'000 : 5'000);
    line.wait(i * 7 % 23);  // until the acknowledgement is read
    line.acknowledge(estimate);
  }
  EXPECT_LT(estimate.transfer_ms(12'000), 12);
}

TEST(LinkEstimate, TheClientsOwnTimeIsNotTheLines) {
  LinkEstimate estimate;
  Line line(500, 10);
  for (const size_t bytes : {8'000, 30'000}) {
    line.send(estimate, bytes);
    line.acknowledge(estimate, 25);
  }
  EXPECT_NEAR(estimate.transfer_ms(50'000), 100, 1);
}

TEST(LinkEstimate, LongMotionAtOneSizeForgetsNothing) {
  LinkEstimate estimate;
  Line line(500, 80);
  line.send(estimate, 100'000);
  line.acknowledge(estimate);
  for (int i = 0; i < 200; ++i) {
    line.send(estimate, 8'000);
    line.acknowledge(estimate);
  }
  EXPECT_NEAR(estimate.transfer_ms(50'000), 100, 5);
}

/// A line of 500 bytes a millisecond whose round trip is known.
class NowEstimate : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const size_t bytes : {1000, 60'000, 60'000, 5000}) exchange(bytes);
    for (int i = 0; i < 20; ++i) exchange(12'000);
  }
  void exchange(size_t bytes) {
    line_.pass(50);
    line_.send(estimate_, bytes);
    line_.acknowledge(estimate_);
  }
  [[nodiscard]] double bytes_a_ms() const {
    return static_cast<double>(estimate_.bytes_now_in(1000, line_.now()).value_or(0)) / 1000;
  }
  LinkEstimate estimate_;
  Line line_{500, 80};
};

TEST_F(NowEstimate, KnowsNothingBeforeTheFirstAcknowledgement) {
  EXPECT_FALSE(LinkEstimate().bytes_now_in(30, line_.now()));
}

TEST_F(NowEstimate, MessagesOfOneSizeTellTheRateAndAQuarterOrSo) {
  EXPECT_GT(bytes_a_ms(), 500);
  EXPECT_LT(bytes_a_ms(), 750);
}

TEST_F(NowEstimate, FollowsALineThatBecomesTenTimesAsSlow) {
  line_.set_rate(50);
  for (int i = 0; i < 2; ++i) exchange(12'000);
  EXPECT_LT(bytes_a_ms(), 60) << "two messages are enough";
  EXPECT_GT(bytes_a_ms(), 45);
}

TEST_F(NowEstimate, OneMessageThatTakesLongChangesNothing) {
  const double before = bytes_a_ms();
  line_.send(estimate_, 12'000);
  line_.wait(60);
  line_.acknowledge(estimate_);
  EXPECT_GE(bytes_a_ms(), before);
}

TEST_F(NowEstimate, AMessageThatIsNotAcknowledgedIsEvidence) {
  const double before = bytes_a_ms();
  line_.send(estimate_, 12'000);
  line_.pass(80 + 24);
  EXPECT_DOUBLE_EQ(bytes_a_ms(), before) << "it is not late yet";
  line_.pass(216);
  EXPECT_NEAR(bytes_a_ms(), 50, 6);
}

TEST_F(NowEstimate, FollowsALineThatIsFastAgain) {
  line_.set_rate(50);
  for (int i = 0; i < 300; ++i) exchange(3000);  // nothing is known of the time before
  EXPECT_LT(bytes_a_ms(), 600);
  line_.set_rate(500);
  int messages = 0;
  for (; messages < 30 && bytes_a_ms() < 450; ++messages) {
    exchange(std::max<size_t>(3000, static_cast<size_t>(20 * bytes_a_ms())));
  }
  EXPECT_LT(messages, 20) << "at ten a second, within two seconds";
  for (int i = 0; i < 30; ++i) exchange(std::max<size_t>(3000, static_cast<size_t>(20 * bytes_a_ms())));
  EXPECT_GT(bytes_a_ms(), 450);
  EXPECT_LT(bytes_a_ms(), 1000);
}

/// Over a line of 50 bytes a millisecond, frames of 20 ms by the estimate and at least 3000 bytes.
TEST_F(NowEstimate, ASlowLineIsNotOverrun) {
  line_.set_rate(50);
  for (int i = 0; i < 600; ++i) {
    exchange(std::max<size_t>(3000, static_cast<size_t>(20 * bytes_a_ms())));
    ASSERT_TRUE(i <= 2 || 20 * bytes_a_ms() < 10'000) << i << ' ' << bytes_a_ms();
  }
}

TEST_F(NowEstimate, SmallMessagesDoNotProveThatLargerOnesFit) {
  const double before = bytes_a_ms();
  for (int i = 0; i < 100; ++i) exchange(1000);
  EXPECT_LE(bytes_a_ms(), 1.3 * before);
}

TEST_F(NowEstimate, TheRoundTripStaysKnownWhenALineBecomesSlowAndFastAgain) {
  // The smallest message, of 1000 bytes, took that.
  EXPECT_NEAR(estimate_.least_elapsed_ms(), 80 + 2, 1);
  for (const double rate : {50, 500}) {
    line_.set_rate(rate);
    for (int i = 0; i < 40; ++i) exchange(12'000);
    EXPECT_NEAR(estimate_.least_elapsed_ms(), 80 + 2, 1) << rate;
  }
}

TEST(LinkEstimate, TheTransferOfTheQuickestMessageIsNoPartOfTheRoundTrip) {
  // The line transfers 6000 bytes in 12 ms and 16,000 in 32. The quickest message takes 92 ms; 80 are the round trip.
  LinkEstimate estimate;
  Line line(500, 80);
  for (int i = 0; i < 60; ++i) {
    line.pass(50);
    line.send(estimate, i < 10 ? 6000 : 16'000);
    line.acknowledge(estimate);
  }
  const auto bytes_a_ms = static_cast<double>(*estimate.bytes_now_in(1000, line.now())) / 1000;
  EXPECT_GT(bytes_a_ms, 500);
  EXPECT_LT(bytes_a_ms, 700);
}

TEST_F(NowEstimate, MessagesThatWaitForOthersTellTheRate) {
  for (int i = 0; i < 3; ++i) line_.send(estimate_, 12'000);
  for (int i = 0; i < 3; ++i) line_.acknowledge(estimate_);
  EXPECT_GT(bytes_a_ms(), 450);
  EXPECT_LT(bytes_a_ms(), 750);
}

TEST(LinkEstimate, AcknowledgementsOfNothingAreIgnored) {
  LinkEstimate estimate;
  EXPECT_FALSE(estimate.acknowledge(3, 0, ViewTime{}));
}

TEST(LinkEstimate, ClaimsOfAClientThatCannotBeDoNoHarm) {
  LinkEstimate estimate;
  Line line(500, 80);
  for (const double ms :
       {std::numeric_limits<double>::quiet_NaN(), -5.0, 1e300, std::numeric_limits<double>::infinity()}) {
    line.send(estimate, 10'000);
    estimate.acknowledge(line.acknowledge(estimate) ? 0 : 1, ms, ViewTime{});
  }
  EXPECT_GT(estimate.transfer_ms(10'000), 0);
  EXPECT_LT(estimate.transfer_ms(10'000), 200);
}

}  // namespace
}  // namespace surfcast::view
