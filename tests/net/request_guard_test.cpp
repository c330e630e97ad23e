#include "net/request_guard.h"

#include <vector>

#include <gtest/gtest.h>

namespace surfcast::net {
namespace {

const std::vector<std::string> kHosts{"render.example"};
const std::vector<std::string> kOrigins{"https://friend.example"};

RequestHead good() {
  RequestHead head;
  head.hosts = 1;
  head.host = "render.example:7600";
  return head;
}

unsigned status_of(const RequestHead& head) {
  const auto refusal = refusal_of(head, {kHosts, kOrigins});
  return refusal ? refusal->status : 200;
}

TEST(RequestGuardTest, OneHostIsNeeded) {
  RequestHead head = good();
  EXPECT_EQ(status_of(head), 200U);
  head.hosts = 2;
  EXPECT_EQ(status_of(head), 400U);
  head.hosts = 1;
  head.host = "";
  EXPECT_EQ(status_of(head), 400U);
  head.hosts = 0;
  EXPECT_EQ(status_of(head), 400U);
  head.version = 10;
  EXPECT_EQ(status_of(head), 200U) << "HTTP/1.0 has none";
}

TEST(RequestGuardTest, AddressesAndNamesOfTheServerAreItsHosts) {
  for (const char* own : {"127.0.0.1", "127.0.0.1:7600", "[::1]", "[::1]:80", "192.0.2.7:1", "localhost",
                          "LOCALHOST:80", "viewer.localhost", "Render.Example", "render.example:1"}) {
    EXPECT_TRUE(is_own_host(own, kHosts)) << own;
  }
  for (const char* other :
       {"attacker.example", "attacker.example:7600", "render.example.attacker", "127.0.0.1.attacker",
        "localhost.attacker", "notlocalhost", "render", "[::1].attacker", "[", "[]", ":80", "1"}) {
    EXPECT_FALSE(is_own_host(other, kHosts)) << other;
  }
  EXPECT_TRUE(is_own_host("attacker.example", std::vector<std::string>{"*"}));
}

TEST(RequestGuardTest, ARequestForAnotherHostIsMisdirected) {
  RequestHead head = good();
  head.host = "attacker.example:7600";
  head.origin = "http://attacker.example:7600";
  EXPECT_EQ(status_of(head), 421U);
  head.version = 10;
  EXPECT_EQ(status_of(head), 421U);
}

TEST(RequestGuardTest, OnlyChunkedBodiesAreUnderstood) {
  RequestHead head = good();
  head.transfer_encodings = 1;
  for (const char* good_one : {"chunked", "Chunked"}) {
    head.transfer_encoding = good_one;
    EXPECT_EQ(status_of(head), 200U) << good_one;
  }
  for (const char* bad : {"gzip", "identity", "xchunked", "\"chunked\"", "chunked, gzip", "gzip, chunked", ""}) {
    head.transfer_encoding = bad;
    EXPECT_EQ(status_of(head), 400U) << bad;
  }
  head.transfer_encoding = "chunked";
  head.transfer_encodings = 2;
  EXPECT_EQ(status_of(head), 400U);
  head.transfer_encodings = 1;
  head.content_length = true;
  EXPECT_EQ(status_of(head), 400U);
  head.content_length = false;
  head.version = 10;
  EXPECT_EQ(status_of(head), 400U);
}

TEST(RequestGuardTest, PagesOfOtherSitesGetNoAnswersUnlessAllowed) {
  RequestHead head = good();
  for (const char* own : {"same-origin", "same-site", "none", ""}) {
    head.fetch_site = own;
    EXPECT_EQ(status_of(head), 200U) << own;
  }
  head.fetch_site = "cross-site";
  head.fetch_mode = "no-cors";
  head.fetch_destination = "image";
  EXPECT_EQ(status_of(head), 403U);
  head.origin = "https://friend.example";
  EXPECT_EQ(status_of(head), 200U);
  head.origin = "https://stranger.example";
  EXPECT_EQ(status_of(head), 403U);
}

TEST(RequestGuardTest, LinksOfOtherSitesMayBeFollowedButNotFramed) {
  RequestHead head = good();
  head.fetch_site = "cross-site";
  head.fetch_mode = "navigate";
  head.fetch_destination = "document";
  EXPECT_EQ(status_of(head), 200U);
  head.fetch_destination = "iframe";
  EXPECT_EQ(status_of(head), 403U);
  head.fetch_destination = "document";
  head.get = false;
  EXPECT_EQ(status_of(head), 403U) << "a form";
}

}  // namespace
}  // namespace surfcast::net
