#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include "access/secret.h"
#include "access/token_file.h"
#include "net/audit_log.h"
#include "net/net_fixture.h"

namespace surfcast::net {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;

std::vector<nlohmann::json> events_in(const fs::path& file) {
  std::vector<nlohmann::json> events;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) events.push_back(nlohmann::json::parse(line));
  return events;
}

class AuditTest : public NetFixture {
 protected:
  void SetUp() override {
    const std::string test = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    file_ = fs::path(::testing::TempDir()) / (test + "_" + std::to_string(::getpid()));
    fs::remove(file_);
  }
  void TearDown() override {
    NetFixture::TearDown();
    fs::remove(file_);
  }
  fs::path file_;
};

TEST(AuditLineTest, AnyValueIsOneMemberOfOneLine) {
  const std::string line = audit_line(
      {.what = "view", .who = "al\"ice", .client = "::1", .connection = 7, .model = "a\n{}", .outcome = "denied"},
      "now");
  EXPECT_EQ(line, R"({"time":"now","event":"view","who":"al\"ice","client":"::1","connection":7,"model":"a\u000a{}",)"
                  R"("outcome":"denied"})");
}

TEST_F(AuditTest, TellsWhoAskedForWhat) {
  ServerConfig config;
  config.audit = file_;
  start(config);
  auto connection = connect();
  ASSERT_TRUE(connection);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(connection->ask(picture_request("cube")));
  wire::Request view;
  *view.mutable_open_view()->mutable_picture() = picture_request("cube").draw_picture();
  ASSERT_TRUE(connection->ask(std::move(view)));
  EXPECT_EQ(get("/api/models/absent/image").substr(9, 3), "404");
  EXPECT_EQ(get("/healthz").substr(9, 3), "200");
  stop();
  std::vector<std::string> told;
  for (const nlohmann::json& event : events_in(file_)) {
    EXPECT_EQ(event.at("client"), "127.0.0.1");
    told.push_back(std::string(event.at("event")) + " " + std::string(event.at("model")));
  }
  EXPECT_THAT(told, ElementsAre("picture cube", "view cube", "picture absent"));
  struct stat status {};
  ASSERT_EQ(::stat(file_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600U);
}

TEST_F(AuditTest, GoesOnInANewFileOnceTheFormerWasMovedAway) {
  {
    auto log = AuditLog::open(file_, 0);
    ASSERT_TRUE(log);
    (*log)->write({.what = "first"});
    ASSERT_TRUE(eventually([&] { return events_in(file_).size() == 1; }));
    fs::remove(file_);
    ASSERT_TRUE((*log)->reopen());
    (*log)->write({.what = "second"});
  }
  const std::vector<nlohmann::json> events = events_in(file_);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].at("event"), "second");
}

TEST_F(AuditTest, AFloodOfDenialsHasFewLines) {
  const std::string secret = access::make_secret();
  ServerConfig config;
  config.audit = file_;
  config.log_lines = 5;
  config.tokens = file_.string() + ".tokens";
  ASSERT_TRUE(
      access::write_tokens(config.tokens, {{.name = "all", .sha256 = access::sha256(secret), .models = {"*"}}}));
  start(config);
  const auto ask = [](const std::string& target, const std::string& token) {
    return "GET " + target + " HTTP/1.1\r\nHost: here\r\nAuthorization: Bearer " + token + "\r\n\r\n";
  };
  RawSocket client(port_);
  for (int i = 0; i < 40; ++i) {
    ASSERT_TRUE(client.send(ask("/healthz", "wrong")));
    ASSERT_EQ(client.read_http().substr(9, 3), "200");
  }
  EXPECT_NE(http(ask("/metrics", secret)).find("\nsurfcast_audit_left_out_total 35\n"), std::string::npos);
  stop();
  fs::remove(config.tokens);
  std::vector<std::string> denied;
  for (const nlohmann::json& event : events_in(file_)) {
    if (event.at("outcome") == "denied") denied.push_back(event.at("event"));
  }
  EXPECT_THAT(denied, ElementsAre("token", "token", "token", "token", "token"));
}

TEST(DenialLimitTest, CountsWhatItLeavesOutForEachClient) {
  using std::chrono::seconds;
  const DenialLimit::Clock::time_point start = DenialLimit::Clock::now();
  DenialLimit limit(2);
  EXPECT_EQ(limit.admit("a", start), 0U);
  EXPECT_EQ(limit.admit("a", start), 0U);
  EXPECT_EQ(limit.admit("a", start), std::nullopt);
  EXPECT_EQ(limit.admit("a", start + seconds(59)), std::nullopt);
  EXPECT_EQ(limit.admit("b", start), 0U) << "another client has lines of its own";
  EXPECT_EQ(limit.admit("a", start + seconds(60)), 2U);
  EXPECT_EQ(limit.admit("a", start + seconds(60)), 0U);
}

TEST(DenialLimitTest, ManyAddressesTogetherHaveALimitToo) {
  const DenialLimit::Clock::time_point now = DenialLimit::Clock::now();
  DenialLimit limit(1);
  size_t written = 0;
  for (int i = 0; i < 20'000; ++i) written += limit.admit(std::to_string(i), now).has_value() ? 1 : 0;
  EXPECT_EQ(written, 100U);
}

TEST_F(AuditTest, AFullDiskLosesEventsAndNothingElse) {
  auto log = AuditLog::open("/dev/full", 0);
  ASSERT_TRUE(log);
  for (int i = 0; i < 3; ++i) (*log)->write({.what = "view", .outcome = "allowed"});
  EXPECT_TRUE(eventually([&] { return (*log)->lost() == 3; }));
}

TEST_F(AuditTest, AFileThatCannotBeOpenedKeepsTheServerFromStarting) {
  ServerConfig config;
  config.audit = "/absent/audit.log";
  auto service = service::RenderService::start(models_, service::fake_renderers(control_), {});
  ASSERT_TRUE(service);
  const auto server = Server::create(**service, config);
  ASSERT_FALSE(server);
  EXPECT_NE(server.error().message.find("/absent/audit.log"), std::string::npos);
}

}  // namespace
}  // namespace surfcast::net
