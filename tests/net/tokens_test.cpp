#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "access/secret.h"
#include "access/token_file.h"
#include "net/gatekeeper.h"
#include "net/http_credentials.h"
#include "net/net_fixture.h"
#include "net/raw_websocket.h"

namespace surfcast::net {
namespace {

namespace fs = std::filesystem;
using access::Principal;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A server that wants tokens: one for the model "cube", one for all.
class TokensTest : public NetFixture {
 protected:
  void SetUp() override {
    const std::string test = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = fs::path(::testing::TempDir()) / (test + "_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    config_.tokens = folder_ / "tokens.json";
    write({some_, all_});
  }
  void TearDown() override {
    NetFixture::TearDown();
    fs::remove_all(folder_);
  }
  void write(const std::vector<Principal>& tokens) const { ASSERT_TRUE(access::write_tokens(config_.tokens, tokens)); }

  [[nodiscard]] std::string ask(const std::string& target, const std::string& headers) const {
    return http("GET " + target + " HTTP/1.1\r\nHost: here\r\nConnection: close\r\n" + headers + "\r\n");
  }
  [[nodiscard]] std::string ask_as(const std::string& secret, const std::string& target) const {
    return ask(target, "Authorization: Bearer " + secret + "\r\n");
  }
  [[nodiscard]] std::string log_in(const std::string& token) const {
    const std::string body = "token=" + token;
    return http("POST /api/login HTTP/1.1\r\nHost: here\r\nContent-Length: " + std::to_string(body.size()) +
                "\r\n\r\n" + body);
  }
  [[nodiscard]] Result<client::ServerConnection> connect_as(const std::string& secret, bool websocket = false) const {
    return client::ServerConnection::open(
        {.host = "127.0.0.1", .port = port_, .websocket = websocket},
        {.connect = milliseconds(10'000), .answer = milliseconds(20'000), .token = secret});
  }
  static wire::Request list_request() {
    wire::Request request;
    request.mutable_list_models();
    return request;
  }
  static wire::Request view_request(const std::string& model) {
    wire::Request request;
    *request.mutable_open_view()->mutable_picture() = picture_request(model).draw_picture();
    return request;
  }

  fs::path folder_;
  ServerConfig config_;
  std::string some_secret_ = access::make_secret();
  std::string all_secret_ = access::make_secret();
  Principal some_{.name = "some", .sha256 = access::sha256(some_secret_), .models = {"cube"}};
  Principal all_{.name = "all", .sha256 = access::sha256(all_secret_), .models = {"*"}};
};

TEST_F(TokensTest, WithoutATokenOnlyHealthIsAnswered) {
  start(config_);
  for (const std::string target : {"/api/models", "/api/models/cube/image", "/metrics", "/absent", "/api/models/x"}) {
    EXPECT_THAT(get(target), AllOf(StartsWith("HTTP/1.1 401"), HasSubstr("WWW-Authenticate: Bearer"))) << target;
  }
  EXPECT_THAT(get("/healthz"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(get("/readyz"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(get("/"), AllOf(StartsWith("HTTP/1.1 401"), HasSubstr("<form")));
  EXPECT_THAT(ask_as(access::make_secret(), "/api/models"), StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(ask_as("", "/api/models"), StartsWith("HTTP/1.1 401"));
  EXPECT_EQ(control_->drawn, 0);
}

TEST_F(TokensTest, EveryCarriageOfATokenOpensItsModels) {
  start(config_);
  EXPECT_THAT(ask_as(some_secret_, "/api/models/cube/image"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(ask("/api/models/cube", "Cookie: a=b; surfcast=" + some_secret_ + "\r\n"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(ask("/api/models/cube", "Cookie: __Host-surfcast=" + some_secret_ + "\r\n"), StartsWith("HTTP/1.1 200"));
  for (const bool websocket : {false, true}) {
    auto connection = connect_as(some_secret_, websocket);
    ASSERT_TRUE(connection) << connection.error().message;
    EXPECT_TRUE(connection->ask(picture_request("cube")));
  }
  RawWebSocket browser(port_, "Cookie: surfcast=" + some_secret_ + "\r\n");
  browser.send_hello();
  browser.read_message();
  ASSERT_TRUE(browser.send(RawWebSocket::kBinary, list_request().SerializeAsString()));
  wire::Answer answer;
  ASSERT_TRUE(answer.ParseFromString(browser.read_message()));
  EXPECT_EQ(answer.model_list().models_size(), 1);
}

TEST_F(TokensTest, ASessionIsGoneOnWithByItsTokenAlone) {
  start(config_);
  std::string session;
  {
    auto first = connect_as(some_secret_);
    ASSERT_TRUE(first);
    session = first->resume("")->session();
    ASSERT_TRUE(first->ask(view_request("cube")));
  }
  auto other = connect_as(all_secret_);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->resume(session)->views_size(), 0);
  auto same = connect_as(some_secret_);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->resume(session)->views_size(), 1);
}

TEST_F(TokensTest, ListsNameOnlyModelsOfTheToken) {
  models_.scan_list = {{.model = "teapot"}, {.model = "cube"}};
  start(config_);
  EXPECT_THAT(ask_as(some_secret_, "/api/models"), AllOf(HasSubstr("cube"), Not(HasSubstr("teapot"))));
  EXPECT_THAT(ask_as(all_secret_, "/api/models"), AllOf(HasSubstr("cube"), HasSubstr("teapot")));
  const auto list = connect_as(some_secret_)->ask(list_request());
  ASSERT_TRUE(list);
  ASSERT_EQ(list->model_list().models_size(), 1);
  EXPECT_EQ(list->model_list().models(0), "cube");
  EXPECT_EQ(list->model_list().scans_size(), 1);
}

/// `answer` with one name in the place of another.
std::string renamed(std::string answer, const std::string& from, const std::string& to) {
  for (size_t at = answer.find(from); at != std::string::npos; at = answer.find(from, at + to.size())) {
    answer.replace(at, from.size(), to);
  }
  return answer;
}

TEST_F(TokensTest, AModelOfOthersAnswersAsOneThatIsAbsent) {
  start(config_);
  for (const std::string what :
       {"", "/image?resolution=4,4", "/pick?resolution=4,4&pixel=1,1", "/profile?line=0,0,0;1,0,0&width=1&format=csv",
        "/points?format=csv", "/points?count=1"}) {
    const std::string other = ask_as(some_secret_, "/api/models/teapot" + what);
    EXPECT_THAT(other, StartsWith("HTTP/1.1 404")) << what;
    EXPECT_EQ(renamed(other, "teapot", "absent"), ask_as(some_secret_, "/api/models/absent" + what)) << what;
  }
  auto connection = connect_as(some_secret_);
  ASSERT_TRUE(connection);
  const auto other = connection->ask(picture_request("teapot"));
  ASSERT_FALSE(other);
  EXPECT_EQ(renamed(other.error().message, "teapot", "absent"),
            connection->ask(picture_request("absent")).error().message);
  wire::Request points;
  points.mutable_get_points()->set_model("teapot");
  const auto region = connection->ask(points);
  ASSERT_FALSE(region);
  EXPECT_EQ(region.error().kind, ErrorKind::kNotFound);
  points.mutable_get_points()->set_model("absent");
  EXPECT_EQ(renamed(region.error().message, "teapot", "absent"), connection->ask(points).error().message);
  const auto view = connection->ask(view_request("teapot"));
  ASSERT_FALSE(view);
  EXPECT_EQ(view.error().kind, ErrorKind::kNotFound);
  EXPECT_TRUE(connection->ask(picture_request("cube")));
}

TEST_F(TokensTest, AConnectionWithoutATokenMayPingAndIsEndedOtherwise) {
  start(config_);
  auto connection = connect();
  ASSERT_TRUE(connection);
  EXPECT_TRUE(connection->ask(ping_request()));
  const auto answer = connection->ask(picture_request("cube"));
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().message, HasSubstr("token"));
  EXPECT_FALSE(connection->ask(ping_request())) << "it has ended";
  stop();
  config_.hello = milliseconds(1500);  // for the hello, too, however busy the machine
  start(config_);
  auto silent = connect();
  ASSERT_TRUE(silent);
  EXPECT_TRUE(eventually([&] { return !silent->ask(ping_request()); })) << "pings do not keep it";
  const auto wrong = connect_as(access::make_secret());
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("not known here"));
}

TEST_F(TokensTest, ALoginSetsACookieThatScriptsDoNotSee) {
  start(config_);
  const std::string answer = log_in(some_secret_);
  EXPECT_THAT(answer,
              AllOf(StartsWith("HTTP/1.1 303"), HasSubstr("Location: /\r\n"),
                    HasSubstr("Set-Cookie: surfcast=" + some_secret_ + "; Path=/; HttpOnly; SameSite=Strict\r\n")));
  EXPECT_THAT(log_in("wrong"), AllOf(StartsWith("HTTP/1.1 401"), HasSubstr("not known here"), HasSubstr("<form")));
  EXPECT_THAT(http("POST /api/logout HTTP/1.1\r\nHost: here\r\nContent-Length: 0\r\n\r\n"),
              HasSubstr("Set-Cookie: surfcast=; Path=/; HttpOnly; SameSite=Strict; Max-Age=0"));
  EXPECT_THAT(http("POST /api/login HTTP/1.1\r\nHost: here\r\nOrigin: http://attacker.example\r\nContent-Length: "
                   "6\r\n\r\ntoken="),
              StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(http("POST /api/login HTTP/1.1\r\nHost: here\r\nContent-Length: 5000\r\n\r\n" + std::string(5000, 'x')),
              StartsWith("HTTP/1.1 400"));
}

TEST_F(TokensTest, ARevokedTokenEndsItsViewsWithTheReason) {
  start(config_);
  auto connection = connect_as(some_secret_);
  auto other = connect_as(all_secret_);
  ASSERT_TRUE(connection && other);
  ASSERT_TRUE(connection->send(view_request("cube")));
  ASSERT_TRUE(connection->receive());
  write({all_});
  std::string reason;
  while (reason.empty()) {
    const auto answer = connection->receive();
    ASSERT_TRUE(answer) << answer.error().message;
    if (answer->has_error()) reason = answer->error().message();
  }
  EXPECT_EQ(reason, "the token was revoked");
  EXPECT_TRUE(eventually([&] { return !connection->ask(ping_request()); }));
  EXPECT_TRUE(other->ask(picture_request("teapot")));
  EXPECT_THAT(ask_as(some_secret_, "/api/models"), StartsWith("HTTP/1.1 401"));
}

TEST_F(TokensTest, ATokenThatExpiresEndsItsConnections) {
  some_.expires = std::chrono::system_clock::now() + std::chrono::seconds(3);
  write({some_});
  start(config_);
  auto connection = connect_as(some_secret_);
  ASSERT_TRUE(connection);
  const auto answer = connection->receive();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->error().code(), wire::ERROR_CODE_DENIED);
  EXPECT_EQ(answer->error().message(), "the token has expired");
}

/// What this process logs from now on, which goes where it went before, too.
class LoggedLines {
 public:
  LoggedLines() {
    auto logger = former_->clone("test");
    logger->sinks().push_back(sink_);
    spdlog::set_default_logger(std::move(logger));
  }
  LoggedLines(const LoggedLines&) = delete;
  LoggedLines& operator=(const LoggedLines&) = delete;
  ~LoggedLines() { spdlog::set_default_logger(former_); }
  [[nodiscard]] bool contains(const std::string& text) const {
    return std::ranges::any_of(sink_->last_formatted(),
                               [&](const std::string& line) { return line.find(text) != std::string::npos; });
  }

 private:
  const std::shared_ptr<spdlog::logger> former_ = spdlog::default_logger();
  const std::shared_ptr<spdlog::sinks::ringbuffer_sink_mt> sink_ =
      std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(100);
};

TEST_F(TokensTest, AFileThatIsNoneLeavesTheFormerTokens) {
  const LoggedLines log;
  start(config_);
  ASSERT_TRUE(write_file_atomically(config_.tokens, std::string_view("nonsense")));
  EXPECT_TRUE(eventually([&] { return log.contains("the former tokens stay"); }));
  EXPECT_THAT(ask_as(some_secret_, "/api/models"), StartsWith("HTTP/1.1 200"));
  stop();  // it logs no more
}

TEST_F(TokensTest, ATokenHasLimitsOfItsOwn) {
  some_.connections = 1;
  some_.views = 1;
  write({some_, all_});
  start(config_);
  auto connection = connect_as(some_secret_);
  ASSERT_TRUE(connection);
  const auto second = connect_as(some_secret_);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("1 connections at a time"));
  EXPECT_THAT(ask_as(some_secret_, "/api/models"), StartsWith("HTTP/1.1 429"));
  EXPECT_TRUE(connect_as(all_secret_));
  ASSERT_TRUE(connection->send(view_request("cube")));
  const auto busy = connection->ask(view_request("cube"));
  ASSERT_FALSE(busy);
  EXPECT_THAT(busy.error().message, HasSubstr("1 views at a time"));
}

TEST_F(TokensTest, ScansAreTakenFromTokensThatMaySendThemUnderTheirNames) {
  some_.uploads = true;
  write({some_, all_});
  config_.uploads.folder = folder_;
  config_.uploads.extensions = {".laz"};
  config_.uploads.serve = [](const fs::path&) { return Status(); };
  start(config_);
  const auto put = [this](const std::string& secret, const std::string& name) {
    return http("PUT /api/uploads/" + name + " HTTP/1.1\r\nHost: here\r\nAuthorization: Bearer " + secret +
                "\r\nContent-Length: 1\r\n\r\nx");
  };
  EXPECT_THAT(put(all_secret_, "cube.laz"), StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(put(some_secret_, "teapot.laz"), StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(put(some_secret_, "cube.laz"), StartsWith("HTTP/1.1 201"));
}

TEST(GatekeeperTest, WhoeverGuessesWaits) {
  const fs::path file = fs::path(::testing::TempDir()) / ("guesses_" + std::to_string(::getpid()));
  ASSERT_TRUE(access::write_tokens(file, {}));
  Gatekeeper gate(file);
  ASSERT_TRUE(gate.read());
  for (int i = 0; i < 10; ++i) gate.enter(access::make_secret(), "10.0.0.1");
  EXPECT_EQ(gate.penalty("10.0.0.1"), milliseconds(0));
  gate.enter("", "10.0.0.1");
  EXPECT_EQ(gate.penalty("10.0.0.1"), milliseconds(1000));
  EXPECT_EQ(gate.penalty("10.0.0.2"), milliseconds(0));
  EXPECT_EQ(gate.denied(), 11U);
  fs::remove(file);
}

TEST(GatekeeperTest, AUserIsOneClientWhereverTheyComeFrom) {
  const auto user = [](size_t connections) {
    return std::make_shared<const Principal>(
        Principal{.name = "some", .sha256 = {}, .models = {}, .connections = connections, .views = 1});
  };
  EXPECT_EQ(client_id("10.0.0.1", user(0)), client_id("10.0.0.2", user(0)));
  EXPECT_NE(client_id("10.0.0.1", user(0)), client_id("10.0.0.1", nullptr));
  EXPECT_NE(client_id("10.0.0.1", nullptr), client_id("10.0.0.2", nullptr));

  const Gatekeeper gate("");
  EXPECT_FALSE(gate.count(nullptr, &Clients::Counts::connections)) << "nobody has no number of their own";
  std::optional<Counted> first = gate.count(user(2), &Clients::Counts::connections);
  EXPECT_EQ(gate.refusal_of_connection(user(2)), "");
  const auto second = gate.count(user(2), &Clients::Counts::connections);
  EXPECT_EQ(gate.refusal_of_connection(user(2)), "busy: this token opens 2 connections at a time");
  EXPECT_EQ(gate.refusal_of_connection(user(0)), "") << "without a limit";
  EXPECT_EQ(gate.refusal_of_connection(nullptr), "");
  EXPECT_EQ(gate.refusal_of_view(user(2)), "") << "views have a limit of their own";
  first = gate.count(user(2), &Clients::Counts::views);
  EXPECT_EQ(gate.refusal_of_connection(user(2)), "");
  EXPECT_EQ(gate.refusal_of_view(user(2)), "busy: this token opens 1 views at a time");
  first.reset();
  EXPECT_EQ(gate.refusal_of_view(user(2)), "");
  EXPECT_EQ(gate.connections(), 1U);
}

TEST(HttpCredentialsTest, AreFoundWhereverTheyAre) {
  EXPECT_EQ(token_of({"Bearer abc", "", ""}), "abc");
  EXPECT_EQ(token_of({"bearer abc", "surfcast=other", ""}), "abc");
  EXPECT_EQ(token_of({"Basic abc", "", ""}), "");
  EXPECT_EQ(token_of({"", "x=y; __Host-surfcast=abc", ""}), "abc");
  EXPECT_EQ(token_of({"", "xsurfcast=abc", ""}), "");
  EXPECT_EQ(token_of({"", "", "surfcast.v1, surfcast.token.abc"}), "abc");
  EXPECT_EQ(token_of({}), "");
  EXPECT_EQ(token_of_form("a=b&token=abc%2d"), "abc-");
  EXPECT_EQ(token_of_form("token=%zz"), "");
  EXPECT_THAT(login_cookie("abc", /*encrypted=*/true), StartsWith("__Host-surfcast=abc; Path=/;"));
  EXPECT_THAT(login_cookie("abc", /*encrypted=*/true), HasSubstr("; Secure"));
}

}  // namespace
}  // namespace surfcast::net
