#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/run_program.h"
#include "model/test_folder.h"
#include "object_store/http_client.h"
#include "object_store/range_server.h"
#include "support/path_of.h"

namespace surfcast::object_store {
namespace {

using testing::RangeServer;

/// What a store would receive, to be compared with what botocore, Amazon's own library, signs.
class SignatureTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ::setenv("no_proxy", "127.0.0.1", 1);
    config_.endpoint = server_.url("");
    config_.region = "eu-central-1";
    config_.credentials = {"AKIDEXAMPLE", "wJalrXUtnFEMI/K7MDENG+bPxRfiCYEXAMPLEKEY", {}};
  }

  void ask(const std::string& url, const std::string& query = {}, const std::optional<ByteRange>& range = {}) {
    const auto client = HttpClient::start(config_);
    ASSERT_TRUE(client) << client.error().message;
    const Result<StorePlace> place = range ? place_of(url, config_) : folder_of(url, config_);
    ASSERT_TRUE(place) << place.error().message;
    HttpRequest request = (*client)->request(*place, query);
    request.range = range;
    if (range) request.headers.emplace_back("If-Match: \"version-1\"");
    (void)(*client)->send_and_wait(std::move(request), [](const HttpAnswer&) { return std::nullopt; });
  }

  /// The requests as JSON, a file that the script reads.
  void write_requests(const std::filesystem::path& path) const {
    nlohmann::json requests = nlohmann::json::array();
    for (const RangeServer::Request& request : server_.requests()) {
      requests.push_back({{"url", server_.url(request.target)}, {"headers", request.headers}});
    }
    const Credentials& credentials = config_.credentials;
    std::ofstream(path) << nlohmann::json{{"key", credentials.key},
                                          {"secret", credentials.secret},
                                          {"session", credentials.session},
                                          {"region", config_.region},
                                          {"requests", requests}};
  }

  RangeServer server_;
  StoreConfig config_;
  model::TestFolder folder_;
};

TEST_F(SignatureTest, SignaturesAreThoseOfBotocore) {
  if (client::run_program("/usr/bin/python3 -c 'import botocore' 2>&1").code != 0)
    GTEST_SKIP() << "no python3-botocore";
  for (const char* session : {"", "FwoGZXIvYXdzEXAMPLE/token+with=signs"}) {
    server_.forget_requests();
    config_.credentials.session = session;
    ask("s3://scans/church.surf", {}, ByteRange{0, 16384});
    ask("s3://scans/2024 (final)/a+b~c, d=\xc3\xa9.surf", {}, ByteRange{100, 5});
    ask("s3://scans/2024/", "?delimiter=%2F&list-type=2&prefix=2024%2F");
    ask("s3://scans/", "?continuation-token=1%2F%2Ba%3D&delimiter=%2F&list-type=2&prefix=");
    ASSERT_EQ(server_.requests().size(), 4U);
    for (const RangeServer::Request& request : server_.requests()) {
      EXPECT_TRUE(request.headers.contains("authorization"));
    }
    write_requests(folder_ / "requests.json");
    const client::ProgramOutcome outcome =
        client::run_program("/usr/bin/python3 " + path_of("tests/object_store/check_signatures.py") + " " +
                            (folder_ / "requests.json").string() + " 2>&1");
    EXPECT_EQ(outcome.code, 0) << outcome.output;
  }
}

TEST_F(SignatureTest, WithoutCredentialsNothingIsSigned) {
  config_.credentials = {};
  ask("s3://scans/church.surf", {}, ByteRange{0, 100});
  ASSERT_EQ(server_.requests().size(), 1U);
  EXPECT_FALSE(server_.requests()[0].headers.contains("authorization"));
}

TEST_F(SignatureTest, CredentialsGoNowhereButToS3) {
  ask(server_.url("/models/church.surf"), {}, ByteRange{0, 100});
  const std::vector<RangeServer::Request> requests = server_.requests();
  ASSERT_EQ(requests.size(), 1U);
  for (const auto& [name, value] : requests[0].headers) {
    EXPECT_EQ(value.find("AKIDEXAMPLE"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace surfcast::object_store
