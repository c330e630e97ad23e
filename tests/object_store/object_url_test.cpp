#include "object_store/object_url.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "object_store/listing.h"

namespace surfcast::object_store {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(ObjectUrlTest, UrlsAreToldFromPaths) {
  for (const char* url : {"https://host/a.surf", "http://host/a.surf", "s3://bucket/a.surf"}) {
    EXPECT_TRUE(is_object_url(url)) << url;
  }
  for (const char* path : {"a.surf", "/models/https:/a.surf", "s3:/bucket", "ftp://host/a.surf", ""}) {
    EXPECT_FALSE(is_object_url(path)) << path;
  }
}

TEST(ObjectUrlTest, AModelIsNamedAsItsFile) {
  EXPECT_EQ(object_name("https://host/a/church.surf"), "church");
  EXPECT_EQ(object_name("https://host/a/church%201.surf?X-Amz-Date=a/b.surf"), "church 1");
  EXPECT_EQ(object_name("s3://bucket/a/50%25 of #1?.surf"), "50%25 of #1?") << "a key is as it is";
  EXPECT_EQ(shown_url("https://host/a.surf?X-Amz-Signature=1"), "https://host/a.surf");
  EXPECT_TRUE(is_model_url("https://host/a.surf?key=1"));
  EXPECT_FALSE(is_model_url("https://host/a.laz?as=.surf"));
}

TEST(ObjectUrlTest, PlacesOfS3FollowFromBucketRegionAndEndpoint) {
  StoreConfig config;
  config.region = "eu-central-1";
  EXPECT_EQ(place_of("s3://scans/a/b c+1.surf", config)->url,
            "https://scans.s3.eu-central-1.amazonaws.com/a/b%20c%2B1.surf");
  EXPECT_EQ(place_of("s3://my.scans/a.surf", config)->url, "https://s3.eu-central-1.amazonaws.com/my.scans/a.surf");
  config.endpoint = "http://127.0.0.1:9000/";
  EXPECT_EQ(place_of("s3://scans/a.surf", config)->url, "http://127.0.0.1:9000/scans/a.surf");
  EXPECT_TRUE(place_of("s3://scans/a.surf", config)->s3);
  EXPECT_EQ(folder_of("s3://scans/2024/", config)->url, "http://127.0.0.1:9000/scans/");
  EXPECT_EQ(folder_of("s3://scans/2024/", config)->prefix, "2024/");
}

TEST(ObjectUrlTest, AUrlOfHttpIsAskedAsItIsAndNeverSigned) {
  const Result<StorePlace> place = place_of("https://host/a%20b.surf?X-Amz-Signature=1", {});
  EXPECT_EQ(place->url, "https://host/a%20b.surf?X-Amz-Signature=1");
  EXPECT_FALSE(place->s3);
}

TEST(ObjectUrlTest, WhatNamesNothingIsRefused) {
  for (const char* url : {"https://", "https:///a.surf", "https://host", "s3://", "s3://bucket", "s3:///key.surf",
                          "s3://buc ket/a.surf", "https://user:password@host/a.surf"}) {
    EXPECT_FALSE(place_of(url, {})) << url;
  }
  EXPECT_EQ(place_of("https://user:password@host/a.surf", {}).error().message.find("password@"), std::string::npos);
}

TEST(ObjectUrlTest, TextIsEncodedAsSignaturesWantIt) {
  EXPECT_EQ(encode_path("a/B-._~ +:\xc3\xa9"), "a/B-._~%20%2B%3A%C3%A9");
  EXPECT_EQ(encode_query("a/b=c"), "a%2Fb%3Dc");
  EXPECT_EQ(decode_percent("a%20b%2Fc%C3%A9"), "a b/c\xc3\xa9");
  EXPECT_EQ(decode_percent("50%, %zz, %1"), "50%, %zz, %1");
}

constexpr const char* kS3List = R"(<?xml version="1.0" encoding="UTF-8"?>
<ListBucketResult xmlns="http://s3.amazonaws.com/doc/2006-03-01/"><Name>scans</Name><Prefix>2024/</Prefix>
<KeyCount>5</KeyCount><IsTruncated>true</IsTruncated><NextContinuationToken>1/+a=</NextContinuationToken>
<Contents><Key>2024/</Key><Size>0</Size></Contents>
<Contents><Key>2024/church.surf</Key><Size>123</Size></Contents>
<Contents><Key>2024/a &amp; b.surf</Key><Size>123</Size></Contents>
<Contents><Key>2024/notes.txt</Key></Contents><Contents><Key>2024/deep/c.surf</Key></Contents>
<Contents><Key>2023/d.surf</Key></Contents><Contents><Key>2024/.surf</Key></Contents>
<CommonPrefixes><Prefix>2024/deep/</Prefix></CommonPrefixes></ListBucketResult>)";

TEST(ListingTest, TheListOfS3GivesTheModelsOfTheFolderAndTheNextPage) {
  const Result<ListingPage> page = parse_listing(kS3List, "2024/");
  ASSERT_TRUE(page);
  EXPECT_THAT(page->models, ElementsAre("church.surf", "a & b.surf"));
  EXPECT_EQ(page->next, "1/+a=");
}

TEST(ListingTest, TheIndexOfNginxIsReadAsHtml) {
  const Result<ListingPage> page = parse_listing(
      "<html>\r\n<head><title>Index of /models/</title></head>\r\n<body>\r\n<h1>Index of /models/</h1><hr><pre>"
      "<a href=\"../\">../</a>\r\n<a href=\"deep/\">deep/</a>  01-Jan-2027 10:00   -\r\n"
      "<a href=\"a%20b.surf\">a b.surf</a>  01-Jan-2027 10:00  123\r\n<a href=\"church.surf\">church.surf</a>\r\n"
      "<a href=\"a%2Fb.surf\">x</a><a href=\"/other/c.surf\">x</a><a href=\"http://other/d.surf\">x</a>"
      "<a href=\"e.surf?x\">x</a><a href=\"church.surf\">again</a><a href=\"scan.laz\">scan.laz</a>"
      "<a href=\"x&amp;y.surf\">x&amp;y</a></pre><hr></body>\r\n</html>\r\n",
      "");
  ASSERT_TRUE(page);
  EXPECT_THAT(page->models, ElementsAre("a b.surf", "church.surf", "x&y.surf"));
  EXPECT_EQ(page->next, "");
}

TEST(ListingTest, TheIndexOfNginxIsReadAsJson) {
  const Result<ListingPage> page = parse_listing(
      "[\r\n{ \"name\":\"deep.surf\", \"type\":\"directory\" },\r\n{ \"name\":\"a b.surf\", \"type\":\"file\", "
      "\"size\":123 },\r\n{ \"name\":\"scan.laz\", \"type\":\"file\" }, 5, { \"name\": 5 }, { \"name\":\"x/y.surf\" "
      "}\r\n]",
      "");
  ASSERT_TRUE(page);
  EXPECT_THAT(page->models, ElementsAre("a b.surf"));
}

TEST(ListingTest, WhatIsNoListIsAnError) {
  for (const char* text : {"", "ok", "[1", "<?xml version=\"1.0\"?><Error><Code>NoSuchBucket</Code></Error>",
                           "<?xml version=\"1.0\"?><ListBucketResult>"}) {
    EXPECT_FALSE(parse_listing(text, "")) << text;
  }
  EXPECT_THAT(parse_listing("<html>It works!</html>", "")->models, IsEmpty());
}

}  // namespace
}  // namespace surfcast::object_store
