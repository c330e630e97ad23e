#include "net/request_window.h"

#include <gtest/gtest.h>

#include "access/authorization.h"

namespace surfcast::net {
namespace {

constexpr RequestWindow::Limits kLimits{.outstanding = 4, .drawing = 2, .outgoing_bytes = 1000};

service::PictureJob any_picture() {
  return {access::Rights::unlimited().authorize("cube")};
}

TEST(RequestWindow, PicturesAreHandedOutInOrderUpToTheLimit) {
  RequestWindow window(kLimits);
  for (uint64_t id = 1; id <= 3; ++id) window.add_picture(id, any_picture());
  EXPECT_EQ(window.next(0)->first, 1u);
  EXPECT_EQ(window.next(0)->first, 2u);
  EXPECT_FALSE(window.next(0));
  window.finish(1);
  EXPECT_EQ(window.next(0)->first, 3u);
}

TEST(RequestWindow, NothingIsDrawnForAClientThatDoesNotRead) {
  RequestWindow window(kLimits);
  window.add_picture(1, any_picture());
  EXPECT_FALSE(window.next(1001));
  EXPECT_TRUE(window.next(1000));
}

TEST(RequestWindow, OtherRequestsDoNotCountAsDrawing) {
  RequestWindow window(kLimits);
  window.add_other(1);
  window.add_other(2);
  window.add_picture(3, any_picture());
  EXPECT_EQ(window.next(0)->first, 3u);
  EXPECT_EQ(window.outstanding(), 3u);
}

TEST(RequestWindow, RequestsBeyondTheLimitAndRepeatedIdsAreRefused) {
  RequestWindow window(kLimits);
  window.add_picture(1, any_picture());
  window.add_other(2);
  EXPECT_EQ(window.admit(1).error().kind, ErrorKind::kInvalidInput);
  EXPECT_EQ(window.admit(2).error().kind, ErrorKind::kInvalidInput);
  EXPECT_TRUE(window.admit(3));
  window.add_picture(3, any_picture());
  window.add_picture(4, any_picture());
  EXPECT_EQ(window.admit(5).error().kind, ErrorKind::kUnavailable);
  window.finish(2);
  EXPECT_TRUE(window.admit(5));
}

TEST(RequestWindow, AnIdMayBeUsedAgainOnceItIsAnswered) {
  RequestWindow window(kLimits);
  window.add_picture(1, any_picture());
  ASSERT_TRUE(window.next(0));
  window.finish(1);
  EXPECT_TRUE(window.admit(1));
  EXPECT_EQ(window.outstanding(), 0u);
}

TEST(RequestWindow, AbandoningForgetsWhatWaitsAndNamesWhatIsUnderWay) {
  RequestWindow window(kLimits);
  for (uint64_t id = 1; id <= 3; ++id) window.add_picture(id, any_picture());
  ASSERT_TRUE(window.next(0));
  window.set_job(1, 77);
  ASSERT_TRUE(window.next(0));
  EXPECT_EQ(window.abandon(), std::vector<service::JobId>{77});
  EXPECT_EQ(window.outstanding(), 2u);
}

TEST(RequestWindow, OnlyWhatWaitsCanBeTakenOut) {
  RequestWindow window(kLimits);
  window.add_picture(1, any_picture());
  window.add_picture(2, any_picture());
  ASSERT_TRUE(window.next(0));
  EXPECT_FALSE(window.remove_waiting(1));
  EXPECT_TRUE(window.remove_waiting(2));
  EXPECT_FALSE(window.remove_waiting(2));
  EXPECT_EQ(window.job(1), std::nullopt);
  window.set_job(1, 5);
  EXPECT_EQ(window.job(1), 5u);
  window.set_job(99, 6);  // one that has finished already
  EXPECT_EQ(window.job(99), std::nullopt);
}

}  // namespace
}  // namespace surfcast::net
