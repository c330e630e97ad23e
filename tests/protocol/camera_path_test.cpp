#include "protocol/camera_path.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace surfcast::protocol {
namespace {

CameraPath path_of(const std::string& keyframes) {
  Result<CameraPath> path = CameraPath::parse("{\"keyframes\": [" + keyframes + "]}");
  EXPECT_TRUE(path) << (path ? "" : path.error().message);
  return std::move(*path);
}

std::string key(double time, double x, const std::string& more = "") {
  return "{\"time\": " + std::to_string(time) + ", \"position\": [" + std::to_string(x) +
         ", 0, 0], \"focal_point\": [" + std::to_string(x) + ", 5, 0]" + more + "}";
}

double x_at(const CameraPath& path, double time) {
  return path.camera_at(time).position().x();
}

TEST(CameraPath, PassesThroughItsKeyframes) {
  const CameraPath path = path_of(key(1, 0) + "," + key(2, 10) + "," + key(4, -3) + "," + key(4.5, 8));
  EXPECT_EQ(x_at(path, 1), 0);
  EXPECT_NEAR(x_at(path, 2), 10, 1e-12);
  EXPECT_NEAR(x_at(path, 4), -3, 1e-12);
  EXPECT_NEAR(x_at(path, 4.5), 8, 1e-12);
  EXPECT_EQ(path.camera_at(2).focal_point().y(), 5);
  EXPECT_FALSE(path.camera_at(2).has_view_up());
}

TEST(CameraPath, MovesEvenlyBetweenEvenKeyframes) {
  const CameraPath path = path_of(key(0, 0) + "," + key(1, 1) + "," + key(2, 2) + "," + key(3, 3));
  for (double t = 1; t <= 2; t += 0.125) EXPECT_NEAR(x_at(path, t), t, 1e-12);
}

TEST(CameraPath, HasNoKinksInItsSpeed) {
  const CameraPath path = path_of(key(0, 0) + "," + key(1, 4) + "," + key(3, 5) + "," + key(3.5, 9));
  constexpr double kStep = 1e-5;
  for (const double t : {1.0, 3.0}) {
    const double before = (x_at(path, t) - x_at(path, t - kStep)) / kStep;
    const double after = (x_at(path, t + kStep) - x_at(path, t)) / kStep;
    EXPECT_NEAR(before, after, 1e-3) << t;
  }
}

TEST(CameraPath, StartsAndEndsAtRestAndRestsWhereItIsAsked) {
  const CameraPath path = path_of(key(0, 0) + "," + key(1, 7) + "," + key(2, 7) + "," + key(3, 0));
  EXPECT_NEAR(x_at(path, 1e-4), 0, 1e-6);
  EXPECT_NEAR(x_at(path, 3 - 1e-4), 0, 1e-6);
  for (double t = 1; t <= 2; t += 0.1) EXPECT_NEAR(x_at(path, t), 7, 1e-12) << "two alike keyframes are a pause";
}

TEST(CameraPath, UpTurnsEvenlyAndStaysPerpendicularToTheView) {
  const CameraPath path = path_of(key(0, 0, ", \"view_up\": [0, 1, 3]") + "," + key(1, 0, ", \"view_up\": [2, 0, 0]"));
  for (double t = 0; t <= 1; t += 0.1) {
    const wire::Vector3 up = path.camera_at(t).view_up();
    EXPECT_NEAR(up.y(), 0, 1e-12) << "the view is along y";
    EXPECT_NEAR(std::hypot(up.x(), up.z()), 1, 1e-12);
  }
  EXPECT_NEAR(path.camera_at(1).view_up().x(), 1, 1e-12);
}

TEST(CameraPath, OppositeUpsTurnWithoutAJump) {
  const CameraPath path = path_of(key(0, 0, ", \"view_up\": [0, 0, 1]") + "," + key(1, 0, ", \"view_up\": [0, 0, -1]"));
  double last = 1;
  for (double t = 0; t <= 1; t += 0.05) {
    const wire::Vector3 up = path.camera_at(t).view_up();
    EXPECT_TRUE(std::isfinite(up.x() + up.y() + up.z()));
    EXPECT_LT(std::abs(up.z() - last), 0.2) << t;
    last = up.z();
  }
}

TEST(CameraPath, FramesIncludeTheFirstAndTheLastKeyframe) {
  const CameraPath path = path_of(key(0.1, 0) + "," + key(0.4, 3));
  EXPECT_EQ(*path.frames(10), 4) << "0.4 - 0.1 is a little less than 0.3";
  EXPECT_NEAR(path.camera_of(3, 10).position().x(), 3, 1e-9);
  EXPECT_EQ(*path.frames(0.5), 1);
  EXPECT_EQ(path_of(key(0, 0) + "," + key(1e9, 3)).frames(1000).error().kind, ErrorKind::kLimit);
}

std::string view(const std::string& parameters) {
  return "{\"name\": \"A view\", \"parameters\": {" + parameters + "}}";
}

CameraPath flight_through(const std::string& views, double seconds_per_view) {
  Result<CameraPath> path =
      CameraPath::parse("{\"format\": \"surfcast-views\", \"views\": [" + views + "]}", seconds_per_view);
  EXPECT_TRUE(path) << (path ? "" : path.error().message);
  return std::move(*path);
}

TEST(CameraPath, PassesThroughSavedViewsInTheirOrder) {
  const std::string rest = R"(, "focal_point": "0,5,0", "view_up": "0,0,1", "color_by": "elevation")";
  const CameraPath path = flight_through(view(R"("position": "0,0,0")" + rest) + "," +
                                             view(R"("position": "10,0,0", "view_angle": "50")" + rest) + "," +
                                             view(R"("position": "-3.5,0,1")" + rest),
                                         2.5);
  EXPECT_EQ(x_at(path, 0), 0);
  EXPECT_NEAR(x_at(path, 2.5), 10, 1e-12);
  EXPECT_NEAR(x_at(path, 5), -3.5, 1e-12);
  EXPECT_EQ(*path.frames(2), 11);
  EXPECT_EQ(path.camera_at(0).view_angle(), 30) << "as in a link";
  EXPECT_NEAR(path.camera_at(2.5).view_angle(), 50, 1e-12);
}

TEST(CameraPath, WrongViewsAreExplained) {
  const std::string good = view(R"("position": "0,0,0", "focal_point": "0,5,0")");
  for (const std::string& second :
       {std::string("7"), std::string("{\"name\": \"None\"}"), view(""), view(R"("position": "1,0,0")"),
        view(R"("position": [1, 0, 0], "focal_point": "0,5,0")"), view(R"("position": "1,0", "focal_point": "0,5,0")"),
        view(R"("position": "1,0,nan", "focal_point": "1,0,0")"),
        view(R"("position": "1,0,0", "focal_point": "0,5,0", "view_angle": "200")"),
        view(R"("position": "1,0,0", "focal_point": "0,5,0", "view_up": "0,0,1")")}) {
    const Result<CameraPath> path = CameraPath::parse("{\"views\": [" + good + ", " + second + "]}");
    ASSERT_FALSE(path) << second;
    EXPECT_EQ(path.error().kind, ErrorKind::kInvalidInput);
    EXPECT_EQ(path.error().message.find('\n'), std::string::npos);
  }
  EXPECT_FALSE(CameraPath::parse("{\"views\": [" + good + "]}")) << "one view is no path";
}

TEST(CameraPath, WrongFilesAreExplained) {
  const std::string good = key(0, 0);
  const char* up = ", \"view_up\": [0, 0, 1]";
  for (const std::string& text :
       {std::string("[]"), std::string("{"), std::string("{\"keyframes\": 3}"), "{\"keyframes\": [" + good + "]}",
        "{\"keyframes\": [" + good + "," + good + "]}", "{\"keyframes\": [" + good + ", {\"time\": 1}]}",
        "{\"keyframes\": [" + good + ", 7]}", "{\"keyframes\": [" + good + "," + key(1, 0, up) + "]}",
        "{\"keyframes\": [" + good + "," + key(1, 0, ", \"view_angle\": 200") + "]}",
        "{\"keyframes\": [" + good + "," + key(1, 0, ", \"fov\": 20") + "]}",
        "{\"keyframes\": [" + good + ", {\"time\": 1, \"position\": [1e999, 0, 0], \"focal_point\": [0, 0, 0]}]}"}) {
    const Result<CameraPath> path = CameraPath::parse(text);
    ASSERT_FALSE(path) << text;
    EXPECT_EQ(path.error().kind, ErrorKind::kInvalidInput);
    EXPECT_EQ(path.error().message.find('\n'), std::string::npos);
  }
}

TEST(FrameName, TheNumberTakesItsPlace) {
  EXPECT_EQ(*frame_name("a_%05d.png", 42), "a_00042.png");
  EXPECT_EQ(*frame_name("%d%%.png", 1234567), "1234567%.png");
  EXPECT_EQ(*frame_name("%03d", 12345), "12345");
}

TEST(FrameName, PatternsWithoutJustOneNumberAreRefused) {
  for (const char* pattern :
       {"a.png", "%d_%d.png", "%s.png", "%", "a%", "%5d.png", "%x", "%-3d", "%099999999999d", "%0100d", "%n", "%%d"}) {
    EXPECT_FALSE(frame_name(pattern, 1)) << pattern;
  }
}

}  // namespace
}  // namespace surfcast::protocol
