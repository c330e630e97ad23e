#include "net/http_route.h"

#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::net {
namespace {

using Resource = ModelRoute::Resource;

TEST(HttpRouteTest, EachTargetHasItsRoute) {
  struct Row {
    std::string_view target;
    std::string_view path;
    HttpRoute route;
  };
  const std::vector<Row> table{
      {"/", "/", ServerRoute::kPage},
      {"/?model=cube", "/", ServerRoute::kPage},
      {"/api/models", "/api/models", ServerRoute::kModels},
      {"/ws", "/ws", ServerRoute::kWebSocket},
      {"/healthz", "/healthz", ServerRoute::kHealth},
      {"/readyz?verbose", "/readyz", ServerRoute::kReady},
      {"/metrics", "/metrics", ServerRoute::kMetrics},
      {"/api/login", "/api/login", ServerRoute::kLogin},
      {"/api/logout", "/api/logout", ServerRoute::kLogout},
      {"/api/models/cube", "/api/models/cube", ModelRoute{Resource::kDescription, "cube", ""}},
      {"/api/models/cube/image?a=%20&b=?", "/api/models/cube/image",
       ModelRoute{Resource::kPicture, "cube", "a=%20&b=?"}},
      {"/api/models/cube/pick?pixel=1,2", "/api/models/cube/pick", ModelRoute{Resource::kPick, "cube", "pixel=1,2"}},
      {"/api/models/cube/profile", "/api/models/cube/profile", ModelRoute{Resource::kProfile, "cube", ""}},
      {"/api/models/cube/points?", "/api/models/cube/points", ModelRoute{Resource::kPoints, "cube", ""}},
      {"/api/models/cube/annotations", "/api/models/cube/annotations", ModelRoute{Resource::kAnnotations, "cube", ""}},
      // Names are unescaped once, and only after the path was taken apart.
      {"/api/models/a%20b", "/api/models/a%20b", ModelRoute{Resource::kDescription, "a b", ""}},
      {"/api/models/a%2Fimage", "/api/models/a%2Fimage", ModelRoute{Resource::kDescription, "a/image", ""}},
      {"/api/models/..%2fb/image", "/api/models/..%2fb/image", ModelRoute{Resource::kPicture, "../b", ""}},
      {"/api/models/a%3Fb", "/api/models/a%3Fb", ModelRoute{Resource::kDescription, "a?b", ""}},
      {"/api/models/image", "/api/models/image", ModelRoute{Resource::kDescription, "image", ""}},
      {"/api/uploads/scan%201.laz?x", "/api/uploads/scan%201.laz", UploadRoute{"scan 1.laz"}},
      {"/api/uploads/a/b", "/api/uploads/a/b", UploadRoute{"a/b"}},
      {"/api/uploads/", "/api/uploads/", UploadRoute{""}},
  };
  for (const Row& row : table) {
    const HttpTarget target = parse_target(row.target);
    EXPECT_EQ(target.path, row.path) << row.target;
    ASSERT_TRUE(target.route) << row.target;
    EXPECT_EQ(*target.route, row.route) << row.target;
  }
}

TEST(HttpRouteTest, OtherTargetsHaveNone) {
  struct Row {
    std::string_view target;
    ErrorKind kind;
    std::string_view message;
  };
  const std::vector<Row> table{
      {"", ErrorKind::kNotFound, "there is nothing at "},
      {"/nothing?x=/", ErrorKind::kNotFound, "there is nothing at /nothing"},
      {"//", ErrorKind::kNotFound, "there is nothing at //"},
      {"/WS", ErrorKind::kNotFound, "there is nothing at /WS"},
      {"/api", ErrorKind::kNotFound, "there is nothing at /api"},
      {"/api/uploads", ErrorKind::kNotFound, "there is nothing at /api/uploads"},
      {"/api/models/", ErrorKind::kNotFound, "there is nothing at /api/models"},
      {"/api/models//image", ErrorKind::kNotFound, "there is nothing at /api/models"},
      {"/api/models/cube/picture", ErrorKind::kNotFound, "there is nothing at /api/models"},
      {"/api/models/cube/image/pick", ErrorKind::kNotFound, "there is nothing at /api/models"},
      {"http://here/ws", ErrorKind::kNotFound, "there is nothing at http://here/ws"},
  };
  for (const Row& row : table) {
    const HttpTarget target = parse_target(row.target);
    ASSERT_FALSE(target.route) << row.target;
    EXPECT_EQ(target.route.error().kind, row.kind) << row.target;
    EXPECT_EQ(target.route.error().message, row.message) << row.target;
  }
  for (const std::string_view target : {"/api/models/%", "/api/models/a%zz/image", "/api/uploads/%2"}) {
    const Result<HttpRoute> route = parse_target(target).route;
    ASSERT_FALSE(route) << target;
    EXPECT_EQ(route.error().kind, ErrorKind::kInvalidInput) << target;
  }
}

TEST(HttpRouteTest, OnlySomeRoutesTakeABody) {
  struct Row {
    std::string_view target;
    HttpMethod method;
    SentBody body;
  };
  const std::vector<Row> table{
      {"/api/login", HttpMethod::kPost, SentBody::kLogin},
      {"/api/logout", HttpMethod::kPost, SentBody::kLogin},
      {"/api/login", HttpMethod::kPut, SentBody::kNone},
      {"/api/login", HttpMethod::kGet, SentBody::kNone},
      {"/api/uploads/a.laz", HttpMethod::kPut, SentBody::kScan},
      {"/api/uploads/a.laz", HttpMethod::kPost, SentBody::kNone},
      {"/api/uploads/%", HttpMethod::kPut, SentBody::kNone},
      {"/api/models/cube/annotations", HttpMethod::kPut, SentBody::kAnnotations},
      {"/api/models/cube/annotations", HttpMethod::kGet, SentBody::kNone},
      {"/api/models/cube/annotations", HttpMethod::kOther, SentBody::kNone},
      {"/api/models/cube/image", HttpMethod::kPut, SentBody::kNone},
      {"/api/models/cube", HttpMethod::kPut, SentBody::kNone},
      {"/", HttpMethod::kPost, SentBody::kNone},
      {"/nothing", HttpMethod::kPut, SentBody::kNone},
  };
  for (const Row& row : table) EXPECT_EQ(body_of(parse_target(row.target).route, row.method), row.body) << row.target;
}

}  // namespace
}  // namespace surfcast::net
