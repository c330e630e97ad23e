#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "object_store/object_store.h"
#include "object_store/range_server.h"

namespace surfcast::object_store {
namespace {

using ::testing::ElementsAre;
using testing::Fault;
using ::testing::HasSubstr;
using testing::RangeServer;

class ListTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ::setenv("no_proxy", "127.0.0.1", 1);
    config_.endpoint = server_.url("");
    config_.retries = 1;
  }

  /// A page of the list of S3; `next`: what asks for the next one.
  static std::string page_of(const std::vector<std::string>& keys, const std::string& next = {}) {
    std::string xml = "<ListBucketResult><IsTruncated>" + std::string(next.empty() ? "false" : "true") +
                      "</IsTruncated><NextContinuationToken>" + next + "</NextContinuationToken>";
    for (const std::string& key : keys) xml += "<Contents><Key>" + key + "</Key></Contents>";
    return xml + "</ListBucketResult>";
  }

  RangeServer server_;
  StoreConfig config_;
};

TEST_F(ListTest, AllPagesOfAFolderOfABucketAreRead) {
  server_.put_page("/scans/?delimiter=%2F&list-type=2&prefix=2024%2F", page_of({"2024/a b.surf"}, "1/+="));
  server_.put_page("/scans/?continuation-token=1%2F%2B%3D&delimiter=%2F&list-type=2&prefix=2024%2F",
                   page_of({"2024/c.surf", "2024/d.laz"}));
  const auto models = ObjectStore(config_).list("s3://scans/2024/");
  ASSERT_TRUE(models) << models.error().message;
  EXPECT_THAT(*models, ElementsAre("s3://scans/2024/a b.surf", "s3://scans/2024/c.surf"));
}

TEST_F(ListTest, TheUrlsOfAnIndexAreEncoded) {
  server_.put_page("/models/?delimiter=%2F&list-type=2&prefix=", "<html><a href=\"a%20b.surf\">a b.surf</a></html>");
  const auto models = ObjectStore(config_).list(server_.url("/models/"));
  ASSERT_TRUE(models) << models.error().message;
  EXPECT_THAT(*models, ElementsAre(server_.url("/models/a%20b.surf")));
}

TEST_F(ListTest, AListBeyondTheLimitIsAnError) {
  server_.put_page("/models/?delimiter=%2F&list-type=2&prefix=", "<html>" + std::string(10'000, ' ') + "</html>");
  config_.listing_bytes = 5'000;
  EXPECT_FALSE(ObjectStore(config_).list(server_.url("/models/")));
  config_.listing_bytes = 20'000;
  EXPECT_TRUE(ObjectStore(config_).list(server_.url("/models/")));
}

TEST_F(ListTest, PagesWithoutEndAreAnError) {
  server_.put_page("/scans/?delimiter=%2F&list-type=2&prefix=", page_of({}, "again"));
  server_.put_page("/scans/?continuation-token=again&delimiter=%2F&list-type=2&prefix=", page_of({}, "again"));
  config_.listing_bytes = 2'000;
  EXPECT_FALSE(ObjectStore(config_).list("s3://scans/"));
}

TEST_F(ListTest, ARefusalNamesTheFolder) {
  server_.fail(Fault::kForbidden, 1);
  const auto models = ObjectStore(config_).list("s3://scans/");
  ASSERT_FALSE(models);
  EXPECT_EQ(models.error().kind, ErrorKind::kIo);
  EXPECT_THAT(models.error().message, HasSubstr("s3://scans/: the store answers 403"));
}

}  // namespace
}  // namespace surfcast::object_store
