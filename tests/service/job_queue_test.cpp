#include "service/job_queue.h"

#include <vector>

#include <gtest/gtest.h>

namespace surfcast::service {
namespace {

std::vector<JobId> drain(JobQueue& queue) {
  std::vector<JobId> jobs;
  while (const auto job = queue.pop(Priority::kStill)) jobs.push_back(*job);
  return jobs;
}

TEST(JobQueue, OneSessionKeepsItsOrder) {
  JobQueue queue(10);
  for (JobId job = 1; job <= 4; ++job) ASSERT_TRUE(queue.push(7, job, Priority::kStill));
  EXPECT_EQ(drain(queue), (std::vector<JobId>{1, 2, 3, 4}));
}

TEST(JobQueue, SessionsTakeTurnsHoweverManyJobsOneHas) {
  JobQueue queue(10);
  for (JobId job = 10; job < 15; ++job) ASSERT_TRUE(queue.push(1, job, Priority::kStill));
  ASSERT_TRUE(queue.push(2, 20, Priority::kStill));
  ASSERT_TRUE(queue.push(3, 30, Priority::kStill));
  ASSERT_TRUE(queue.push(2, 21, Priority::kStill));
  EXPECT_EQ(drain(queue), (std::vector<JobId>{10, 20, 30, 11, 21, 12, 13, 14}));
}

TEST(JobQueue, ASessionThatWasServedWaitsBehindTheOthers) {
  JobQueue queue(10);
  ASSERT_TRUE(queue.push(1, 10, Priority::kStill));
  ASSERT_TRUE(queue.push(2, 20, Priority::kStill));
  EXPECT_EQ(queue.pop(Priority::kStill), 10u);
  ASSERT_TRUE(queue.push(1, 11, Priority::kStill));
  EXPECT_EQ(drain(queue), (std::vector<JobId>{20, 11}));
}

TEST(JobQueue, OthersAreServedInTheirTurnAndTheSessionKeepsItsPlace) {
  JobQueue queue(10);
  for (JobId job = 10; job < 12; ++job) ASSERT_TRUE(queue.push(1, job, Priority::kStill));
  ASSERT_TRUE(queue.push(2, 20, Priority::kStill));
  ASSERT_TRUE(queue.push(3, 30, Priority::kStill));
  EXPECT_EQ(queue.pop_of_others(Priority::kStill, 1), 20u);
  EXPECT_EQ(queue.pop_of_others(Priority::kStill, 1), 30u);
  EXPECT_FALSE(queue.pop_of_others(Priority::kStill, 1));
  EXPECT_EQ(drain(queue), (std::vector<JobId>{10, 11}));
}

TEST(JobQueue, AFullQueueTakesNothingUntilAJobLeaves) {
  JobQueue queue(2);
  ASSERT_TRUE(queue.push(1, 1, Priority::kStill));
  ASSERT_TRUE(queue.push(2, 2, Priority::kStill));
  EXPECT_FALSE(queue.push(3, 3, Priority::kStill));
  EXPECT_EQ(queue.size(), 2u);
  EXPECT_EQ(queue.pop(Priority::kStill), 1u);
  EXPECT_TRUE(queue.push(3, 3, Priority::kStill));
  EXPECT_EQ(drain(queue), (std::vector<JobId>{2, 3}));
}

TEST(JobQueue, WhatMotionsWaitForIsALineOfItsOwnWithinOneLimit) {
  JobQueue queue(3);
  ASSERT_TRUE(queue.push(1, 10, Priority::kStill));
  EXPECT_FALSE(queue.has_waiting(Priority::kMotion));
  ASSERT_TRUE(queue.push(1, 11, Priority::kMotion));
  ASSERT_TRUE(queue.push(2, 20, Priority::kMotion));
  EXPECT_FALSE(queue.push(3, 30, Priority::kMotion));
  EXPECT_TRUE(queue.contains(20));
  EXPECT_TRUE(queue.remove(11));
  EXPECT_EQ(queue.pop(Priority::kMotion), 20u);
  EXPECT_EQ(queue.pop(Priority::kMotion), std::nullopt);
  EXPECT_TRUE(queue.has_waiting(Priority::kStill));
  EXPECT_EQ(queue.size(), 1u);
}

TEST(JobQueue, ARemovedJobIsNeverHandedOut) {
  JobQueue queue(10);
  ASSERT_TRUE(queue.push(1, 1, Priority::kStill));
  ASSERT_TRUE(queue.push(1, 2, Priority::kStill));
  ASSERT_TRUE(queue.push(2, 3, Priority::kStill));
  EXPECT_TRUE(queue.remove(1));
  EXPECT_TRUE(queue.remove(3));
  EXPECT_FALSE(queue.remove(3));
  EXPECT_EQ(queue.size(), 1u);
  EXPECT_EQ(drain(queue), (std::vector<JobId>{2}));
  EXPECT_EQ(queue.size(), 0u);
}

TEST(JobQueue, TheClientOnWhichLeastTimeWasSpentComesFirst) {
  JobQueue queue(10);
  ASSERT_TRUE(queue.push({7, 1}, 10, Priority::kStill));
  ASSERT_TRUE(queue.push({7, 2}, 20, Priority::kStill));
  ASSERT_TRUE(queue.push({8, 3}, 30, Priority::kStill));
  queue.shares().charge(7, 5);
  EXPECT_EQ(queue.next_client(Priority::kStill), 8U);
  EXPECT_EQ(drain(queue), (std::vector<JobId>{30, 10, 20}));
}

TEST(JobQueue, AJobThatIsNotAcceptedHoldsUpItsSessionAlone) {
  JobQueue queue(10);
  ASSERT_TRUE(queue.push(1, 10, Priority::kStill));
  ASSERT_TRUE(queue.push(1, 11, Priority::kStill));
  ASSERT_TRUE(queue.push(2, 20, Priority::kStill));
  const auto not_the_first = [](JobId job) { return job != 10; };
  EXPECT_EQ(queue.pop(Priority::kStill, not_the_first), 20U);
  EXPECT_EQ(queue.pop(Priority::kStill, not_the_first), std::nullopt);
}

TEST(JobQueue, OneClientLeavesPlacesForOthers) {
  JobQueue queue(16);
  for (JobId job = 0; job < 14; ++job) ASSERT_TRUE(queue.push({7, job}, job, Priority::kStill));
  EXPECT_FALSE(queue.push({7, 99}, 99, Priority::kStill));
  EXPECT_TRUE(queue.push({8, 100}, 100, Priority::kStill));
}

TEST(JobQueue, AnEmptyQueueHasNothing) {
  JobQueue queue(1);
  EXPECT_EQ(queue.pop(Priority::kStill), std::nullopt);
  EXPECT_FALSE(queue.remove(1));
}

}  // namespace
}  // namespace surfcast::service
