#include "object_store/range_answer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "object_store/http_client.h"

namespace surfcast::object_store {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const ObjectVersion kVersion{"\"a\"", 1000};
constexpr ByteRange kAsked{100, 50};

HttpAnswer good_answer() {
  HttpAnswer answer;
  answer.status = 206;
  answer.etag = "\"a\"";
  answer.content_range = "bytes 100-149/1000";
  answer.body.resize(50);
  return answer;
}

TEST(RangeAnswerTest, ExactlyWhatWasAskedForIsTaken) {
  EXPECT_FALSE(check_range_answer(good_answer(), kAsked, kVersion));
  HttpAnswer without_etag = good_answer();
  without_etag.etag.clear();
  EXPECT_FALSE(check_range_answer(without_etag, kAsked, kVersion)) << "If-Match has seen to it";
}

TEST(RangeAnswerTest, OfAContentRangeOnlyTheRightOneCounts) {
  for (const char* range :
       {"bytes 99-148/1000", "bytes 100-150/1000", "bytes 100-149/*", "bytes */1000", "100-149/1000", "bytes 100-149",
        "bytes 149-100/1000", "bytes 100-149/1000x", "bytes -100-149/1000", ""}) {
    HttpAnswer answer = good_answer();
    answer.content_range = range;
    const std::optional<AnswerFault> fault = check_range_answer(answer, kAsked, kVersion);
    ASSERT_TRUE(fault) << range;
    EXPECT_EQ(fault->error.kind, ErrorKind::kInvalidInput) << range;
    EXPECT_FALSE(fault->again);
  }
}

TEST(RangeAnswerTest, AnotherVersionIsAReplacedObject) {
  HttpAnswer refused;
  refused.status = 412;
  HttpAnswer other = good_answer();
  other.etag = "\"b\"";
  HttpAnswer longer = good_answer();
  longer.content_range = "bytes 100-149/1001";
  for (const HttpAnswer& answer : {refused, other, longer}) {
    const std::optional<AnswerFault> fault = check_range_answer(answer, kAsked, kVersion);
    ASSERT_TRUE(fault);
    EXPECT_EQ(fault->error.kind, ErrorKind::kReplaced);
    EXPECT_THAT(fault->error.message, HasSubstr("replaced"));
    EXPECT_FALSE(fault->again);
  }
}

TEST(RangeAnswerTest, WhatMayPassIsAskedAgain) {
  for (const int status : {408, 429, 500, 502, 503, 504}) {
    HttpAnswer answer;
    answer.status = status;
    const std::optional<AnswerFault> fault = check_range_answer(answer, kAsked, kVersion);
    ASSERT_TRUE(fault);
    EXPECT_EQ(fault->error.kind, ErrorKind::kUnavailable) << status;
    EXPECT_TRUE(fault->again) << status;
  }
  HttpAnswer short_one = good_answer();
  short_one.body.resize(49);
  EXPECT_TRUE(check_range_answer(short_one, kAsked, kVersion)->again);
  HttpAnswer broken = good_answer();
  broken.fault = "reset";
  EXPECT_TRUE(check_range_answer(broken, kAsked, kVersion)->again);
}

TEST(RangeAnswerTest, EveryOtherStatusIsAnErrorAtOnce) {
  const std::vector<std::pair<int, ErrorKind>> kinds{
      {200, ErrorKind::kUnsupported}, {302, ErrorKind::kUnsupported},  {401, ErrorKind::kIo}, {403, ErrorKind::kIo},
      {404, ErrorKind::kNotFound},    {416, ErrorKind::kInvalidInput}, {418, ErrorKind::kIo}};
  for (const auto& [status, kind] : kinds) {
    HttpAnswer answer = good_answer();
    answer.status = status;
    const std::optional<AnswerFault> fault = check_range_answer(answer, kAsked, kVersion);
    ASSERT_TRUE(fault) << status;
    EXPECT_EQ(fault->error.kind, kind) << status;
    EXPECT_FALSE(fault->again) << status;
  }
}

TEST(RangeAnswerTest, ARedirectionIsNamedWithoutTheSignatureThatItMayHold) {
  HttpAnswer answer;
  answer.status = 307;
  answer.location = "https://elsewhere/a.surf?X-Amz-Signature=secret";
  const std::optional<AnswerFault> fault = check_range_answer(answer, kAsked, kVersion);
  ASSERT_TRUE(fault);
  EXPECT_THAT(fault->error.message, Not(HasSubstr("elsewhere")));
  EXPECT_EQ(fault->detail, "https://elsewhere/a.surf");
}

TEST(RangeAnswerTest, TheFirstAnswerStatesTheVersion) {
  HttpAnswer answer = good_answer();
  answer.content_range = "bytes 0-49/1000";
  ObjectVersion version;
  EXPECT_FALSE(check_first_answer(answer, 50, version));
  EXPECT_EQ(version.etag, "\"a\"");
  EXPECT_EQ(version.size, 1000U);
  EXPECT_TRUE(check_first_answer(answer, 60, version)) << "the object has 60 bytes, and they were asked for";
  answer.content_range = "bytes 0-49/50";
  EXPECT_FALSE(check_first_answer(answer, 60, version)) << "all of a small object";
}

TEST(RangeAnswerTest, WithoutAStrongEtagNothingIsOpened) {
  for (const char* etag : {"", "W/\"a\"", "a", "\""}) {
    HttpAnswer answer = good_answer();
    answer.content_range = "bytes 0-49/1000";
    answer.etag = etag;
    ObjectVersion version;
    const std::optional<AnswerFault> fault = check_first_answer(answer, 50, version);
    ASSERT_TRUE(fault) << etag;
    EXPECT_EQ(fault->error.kind, ErrorKind::kUnsupported) << etag;
  }
}

TEST(RangeAnswerTest, AnObjectIsNewerThanItsFolderBySecondsOfTheStore) {
  HttpAnswer answer = good_answer();
  EXPECT_FALSE(is_newer(answer, 1000)) << "the store does not say when it was written";
  answer.written = 1000;
  EXPECT_FALSE(is_newer(answer, 1000));
  EXPECT_TRUE(is_newer(answer, 999));
  EXPECT_FALSE(is_newer(answer, std::nullopt));
}

TEST(RangeAnswerTest, PausesDoubleAndVaryByHalf) {
  using std::chrono::milliseconds;
  EXPECT_EQ(retry_pause(1, 0), milliseconds(50));
  EXPECT_EQ(retry_pause(1, 0.5), milliseconds(100));
  EXPECT_EQ(retry_pause(3, 0.5), milliseconds(400));
  EXPECT_EQ(retry_pause(1000, 0.5), milliseconds(6400));
}

}  // namespace
}  // namespace surfcast::object_store
