#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <unistd.h>

#include "access/secret.h"
#include "access/token_file.h"
#include "model/write_model.h"
#include "net/net_fixture.h"
#include "support/clouds.h"

namespace surfcast::net {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const surfel::Grid kLattice{{0.001, 0.001, 0.001}, {448'262, 5'411'932, 0}};

/// Points on a lattice, in long numbers.
surfel::SurfelCloud scan_of(int side) {
  surfel::SurfelCloud cloud = testing::square(side, 120, {0, 0, 0}, {0, 0, 1}, {10, 20, 30});
  std::vector<uint32_t> numbers;
  for (size_t i = 0; i < cloud.size(); ++i) {
    glm::dvec3& p = cloud.positions[i];
    p.z = 4 * std::sin(0.2 * p.x) * std::cos(0.13 * p.y);
    p = kLattice.position(kLattice.index(p + kLattice.offset));
    numbers.push_back(static_cast<uint32_t>(i));
  }
  cloud.sources[0].grid = kLattice;
  cloud.scalars = {{"number", numbers}};
  return cloud;
}

class PointsTest : public NetFixture {
 protected:
  void TearDown() override {
    NetFixture::TearDown();
    models_.cube_file.reset();
    std::filesystem::remove(path_);
  }
  /// Serves a scan as the model "cube".
  void serve(const surfel::SurfelCloud& cloud, const service::ServiceLimits& limits = {},
             const ServerConfig& config = {}) {
    path_ = std::filesystem::path(::testing::TempDir()) /
            (std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + std::to_string(::getpid()) +
             ".surf");
    ASSERT_TRUE(model::write_model(cloud, path_, {}));
    Result<model::ModelFile> model = model::ModelFile::open(path_);
    ASSERT_TRUE(model);
    models_.cube_file = std::make_shared<const model::ModelFile>(std::move(*model));
    start(config, limits);
  }

  /// What the server answers until it closes the connection.
  [[nodiscard]] std::string fetch(const std::string& query, const std::string& version = "1.1") const {
    RawSocket socket(port_);
    socket.send("GET /api/models/cube/points?" + query + " HTTP/" + version +
                "\r\nHost: here\r\nConnection: close\r\n\r\n");
    return socket.read_to_end();
  }
  /// The body of such an answer; its pieces are joined.
  [[nodiscard]] static std::string body_of(const std::string& answer) {
    size_t at = answer.find("\r\n\r\n") + 4;
    if (answer.find("Transfer-Encoding: chunked") == std::string::npos) return answer.substr(at);
    std::string body;
    for (;;) {
      const size_t length = std::stoul(answer.substr(at, answer.find("\r\n", at) - at), nullptr, 16);
      at = answer.find("\r\n", at) + 2;
      body += answer.substr(at, length);
      at += length + 2;
      if (length == 0) return body;
    }
  }
  static wire::Request request_of(wire::PointFormat format, const glm::dvec3& low, const glm::dvec3& high) {
    wire::Request request;
    wire::GetPoints& points = *request.mutable_get_points();
    points.set_model("cube");
    points.set_format(format);
    wire::Box& box = *points.add_boxes();
    box.mutable_min()->set_x(low.x);
    box.mutable_min()->set_y(low.y);
    box.mutable_min()->set_z(low.z);
    box.mutable_max()->set_x(high.x);
    box.mutable_max()->set_y(high.y);
    box.mutable_max()->set_z(high.z);
    return request;
  }
  /// The file that the messages of one answer make, and how many points it is said to have.
  static std::pair<std::string, uint64_t> receive(client::ServerConnection& connection) {
    std::string file;
    uint64_t total = 0;
    for (bool more = true, first = true; more; first = false) {
      const auto answer = connection.receive();
      EXPECT_TRUE(answer && answer->has_points()) << (answer ? answer->error().message() : answer.error().message);
      if (!answer || !answer->has_points()) break;
      if (first) total = answer->points().total();
      file += answer->points().data();
      more = answer->points().more();
    }
    return {file, total};
  }

  std::filesystem::path path_;
};

std::string box_text(const glm::dvec3& low, const glm::dvec3& high) {
  std::ostringstream text;
  text.precision(17);
  text << low.x << ',' << low.y << ',' << low.z << ',' << high.x << ',' << high.y << ',' << high.z;
  return text.str();
}

TEST_F(PointsTest, OfABoxAreThoseThatAFilterOfTheScanFinds) {
  const surfel::SurfelCloud cloud = scan_of(300);
  serve(cloud);
  const glm::dvec3 low = kLattice.offset + glm::dvec3(-20, -11.5, -1), high = kLattice.offset + glm::dvec3(8.25, 30, 2);
  std::set<size_t> expected;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const glm::dvec3& p = cloud.positions[i];
    if (p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z)
      expected.insert(i);
  }
  ASSERT_GT(expected.size(), 1000U);
  const std::string answer = fetch("box=" + box_text(low, high));
  EXPECT_THAT(answer,
              AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("X-Surfcast-Points: " + std::to_string(expected.size())),
                    HasSubstr("attachment; filename=\"cube-points.csv\"")));
  std::istringstream lines(body_of(answer));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "x,y,z,red,green,blue,number");
  while (std::getline(lines, line)) {
    std::array<double, 7> v{};
    std::istringstream fields(line);
    std::string field;
    for (double& value : v) {
      std::getline(fields, field, ',');
      value = std::stod(field);
    }
    const auto number = static_cast<size_t>(v[6]);
    EXPECT_EQ(expected.erase(number), 1U) << line;
    EXPECT_EQ(glm::dvec3(v[0], v[1], v[2]), cloud.positions[number]) << "to the last bit";
    EXPECT_EQ(v[3], 10);
  }
  EXPECT_TRUE(expected.empty());
}

TEST_F(PointsTest, MakeTheSameFileByEveryWay) {
  service::ServiceLimits limits;
  limits.picks.region_bytes = 10'000;  // many pieces
  serve(scan_of(300), limits);
  const glm::dvec3 low = kLattice.offset - 30.0, high = kLattice.offset + 30.0;
  for (const auto& [name, format] : {std::pair{"las", wire::POINT_FORMAT_LAS}, std::pair{"laz", wire::POINT_FORMAT_LAZ},
                                     std::pair{"ply", wire::POINT_FORMAT_PLY}, std::pair{"csv", wire::POINT_FORMAT_CSV},
                                     std::pair{"npy", wire::POINT_FORMAT_NPY}}) {
    const std::string query = "box=" + box_text(low, high) + "&format=" + name;
    const std::string file = body_of(fetch(query));
    EXPECT_GT(file.size(), 30'000U) << name;
    EXPECT_TRUE(body_of(fetch(query, "1.0")) == file) << name;
    for (const bool websocket : {false, true}) {
      auto connection =
          client::ServerConnection::open({.host = "127.0.0.1", .port = port_, .websocket = websocket},
                                         {.connect = milliseconds(10'000), .answer = milliseconds(20'000)});
      ASSERT_TRUE(connection);
      ASSERT_TRUE(connection->send(request_of(format, low, high)));
      const auto [received, total] = receive(*connection);
      EXPECT_TRUE(received == file) << name;
      EXPECT_GT(total, 10'000U);
    }
  }
}

TEST_F(PointsTest, AreCountedWithoutBeingSent) {
  const surfel::SurfelCloud cloud = scan_of(100);
  service::ServiceLimits limits;
  limits.picks.region_points = 10;  // counting has no limit
  serve(cloud, limits);
  EXPECT_THAT(fetch("count=1"), AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("{\n  \"points\": 10000\n}"),
                                      HasSubstr("X-Surfcast-Max-Points: 10\r\n")));
  EXPECT_THAT(fetch("count=1&max_points=7"), HasSubstr("X-Surfcast-Max-Points: 7\r\n"));
  EXPECT_THAT(fetch("count=1&every=3"), HasSubstr("\"points\": 3334"));
  auto connection = connect();
  ASSERT_TRUE(connection);
  wire::Request request = request_of(wire::POINT_FORMAT_LAS, kLattice.offset - 900.0, kLattice.offset + 900.0);
  request.mutable_get_points()->set_only_count(true);
  const auto answer = connection->ask(request);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->points().total(), 10000U);
  EXPECT_FALSE(answer->points().more());
}

TEST_F(PointsTest, BeyondTheLimitAreRefusedBeforeTheFirstIsSent) {
  service::ServiceLimits limits;
  limits.picks.region_points = 9'999;
  serve(scan_of(100), limits);
  EXPECT_THAT(fetch(""), AllOf(StartsWith("HTTP/1.1 400"), HasSubstr("\"kind\": \"limit\""),
                               HasSubstr("the region has more than 9999 points")));
  EXPECT_THAT(fetch("every=2"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(fetch("every=2&max_points=4999"), HasSubstr("more than 4999 points"));
  EXPECT_THAT(fetch("max_points=4000000000"), HasSubstr("more than 9999 points")) << "a client cannot raise it";
}

TEST_F(PointsTest, OfAnEmptyRegionOrOneOutsideAreNone) {
  serve(scan_of(100));
  const glm::dvec3 between = kLattice.offset + glm::dvec3(0.1, 0.1, 20);
  for (const glm::dvec3& low : {between, glm::dvec3(-1)}) {
    const std::string answer = fetch("bounds=" + box_text(low, low + 0.1));
    EXPECT_THAT(answer, AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("X-Surfcast-Points: 0")));
    EXPECT_EQ(body_of(answer), "x,y,z,red,green,blue,number\n");
    EXPECT_THAT(body_of(fetch("format=las&box=" + box_text(low, low + 0.1))), StartsWith("LASF"));
    EXPECT_THAT(fetch("count=1&box=" + box_text(low, low + 0.1)), HasSubstr("\"points\": 0"));
  }
}

TEST_F(PointsTest, OfABoxThatIsNoneAreAnError) {
  serve(scan_of(20));
  const std::pair<const char*, const char*> wrong[] = {
      {"box=1,0,0,0,1,1", "box: the lower corner must come first"},
      {"box=nan,0,0,1,1,1", "box: expected X,Y,Z,X,Y,Z of two corners"},
      {"box=0,0,0,inf,1,1", "box: expected X,Y,Z,X,Y,Z of two corners"},
      {"box=0,0,1,1", "box: expected X,Y,Z,X,Y,Z of two corners"},
      {"box=0,0,0,1,1,1&box=0,0,0,1,1,1", "box: given twice"},
      {"corridor=0,0,0,1,1", "corridor: its width must be a finite number above 0"},
      {"corridor=1,0,0", "corridor: expected WIDTH,X,Y,X,Y"},
      {"corridor=1,0,0,1,1@2,1", "corridor: the lower height must come first"},
      {"classes=256", "classes: expected a list of codes"},
      {"classes=2", "cube: has no classification to choose points by"},
      {"every=0", "every: expected a count above 0"},
      {"format=e57", "'e57' is not a format of points: las, laz, ply, csv, npy"},
      {"colour=1", "there is no parameter 'colour'"},
  };
  for (const auto& [query, message] : wrong) {
    EXPECT_THAT(fetch(query), AllOf(StartsWith("HTTP/1.1 400"), HasSubstr(message))) << query;
  }
  auto connection = connect();
  ASSERT_TRUE(connection);
  for (const auto& [low, high] : {std::pair(glm::dvec3(1), glm::dvec3(0)), std::pair(glm::dvec3(NAN), glm::dvec3(1)),
                                  std::pair(glm::dvec3(0), glm::dvec3(INFINITY))}) {
    const auto answer = connection->ask(request_of(wire::POINT_FORMAT_LAS, low, high));
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().kind, ErrorKind::kInvalidInput);
  }
}

/// More text than the buffers of a connection take, for one client at a time.
class SlowPointsTest : public PointsTest {
 protected:
  void SetUp() override {
    service::ServiceLimits limits;
    limits.picks.regions = 1;
    ServerConfig config;
    config.drain = milliseconds(200);
    surfel::SurfelCloud cloud = scan_of(600);
    std::vector<double> roots;
    for (size_t i = 0; i < cloud.size(); ++i) roots.push_back(std::sqrt(static_cast<double>(i)));
    cloud.scalars.push_back({"root", roots});
    serve(cloud, limits, config);
  }
  [[nodiscard]] bool busy() const { return fetch("count=1").starts_with("HTTP/1.1 503"); }
};

TEST_F(SlowPointsTest, AClientOfHttpThatLeavesInTheMiddleFreesItsPlace) {
  RawSocket socket(port_, 4096);
  ASSERT_TRUE(socket.send("GET /api/models/cube/points HTTP/1.1\r\nHost: here\r\n\r\n"));
  EXPECT_THAT(socket.read_exactly(4096), StartsWith("HTTP/1.1 200"));
  EXPECT_TRUE(busy()) << "it has not taken its file";
  socket.close();
  EXPECT_TRUE(eventually([this] { return !busy(); }));
}

TEST_F(SlowPointsTest, AClientOfMessagesThatLeavesInTheMiddleFreesItsPlace) {
  {
    auto connection = connect();
    ASSERT_TRUE(connection);
    ASSERT_TRUE(connection->send(request_of(wire::POINT_FORMAT_CSV, glm::dvec3(-1e9), glm::dvec3(1e9))));
    EXPECT_EQ(connection->receive()->points().total(), 360'000U);
    EXPECT_TRUE(busy());
  }
  EXPECT_TRUE(eventually([this] { return !busy(); }));
}

TEST_F(SlowPointsTest, ThatAreCancelledEndWithOneAnswerAndOthersGoOn) {
  auto connection = connect();
  ASSERT_TRUE(connection);
  const auto id = connection->send(request_of(wire::POINT_FORMAT_CSV, glm::dvec3(-1e9), glm::dvec3(1e9)));
  ASSERT_TRUE(id);
  EXPECT_TRUE(connection->receive()->points().more());
  wire::Request cancel;
  cancel.mutable_cancel()->set_request_id(*id);
  ASSERT_TRUE(connection->send(cancel));
  for (;;) {
    const auto answer = connection->receive();
    ASSERT_TRUE(answer);
    if (answer->has_points()) continue;
    EXPECT_EQ(answer->id(), *id);
    EXPECT_EQ(answer->error().code(), wire::ERROR_CODE_CANCELLED);
    break;
  }
  EXPECT_TRUE(connection->receive()->cancel_result().was_outstanding());
  EXPECT_TRUE(connection->ask(ping_request())->has_pong());
  EXPECT_TRUE(eventually([this] { return !busy(); }));
}

TEST_F(SlowPointsTest, LetOtherRequestsOfTheirConnectionBy) {
  auto connection = connect();
  ASSERT_TRUE(connection);
  ASSERT_TRUE(connection->send(request_of(wire::POINT_FORMAT_CSV, glm::dvec3(-1e9), glm::dvec3(1e9))));
  const auto ping = connection->send(ping_request());
  ASSERT_TRUE(ping);
  bool whole = false, answered = false;
  for (; !whole;) {
    const auto answer = connection->receive();
    ASSERT_TRUE(answer);
    answered |= answer->id() == *ping;
    whole = answer->has_points() && !answer->points().more();
  }
  EXPECT_TRUE(answered) << "before the end of the file";
}

TEST_F(SlowPointsTest, StopWithTheServer) {
  RawSocket socket(port_, 4096);
  ASSERT_TRUE(socket.send("GET /api/models/cube/points HTTP/1.1\r\nHost: here\r\n\r\n"));
  EXPECT_THAT(socket.read_exactly(4096), StartsWith("HTTP/1.1 200"));
  stop();
  const std::string rest = socket.read_to_end();
  EXPECT_FALSE(rest.ends_with("0\r\n\r\n")) << "what is not whole has no end";
}

TEST_F(PointsTest, AClientThatDoesNotReadKeepsNobodyWaiting) {
  serve(scan_of(600));
  std::vector<RawSocket> idle;
  for (int i = 0; i < 4; ++i) {
    idle.emplace_back(port_, 4096);
    ASSERT_TRUE(idle.back().send("GET /api/models/cube/points HTTP/1.1\r\nHost: here\r\n\r\n"));
    EXPECT_THAT(idle.back().read_exactly(1000), StartsWith("HTTP/1.1 200"));
  }
  EXPECT_TRUE(fetch("").ends_with("0\r\n\r\n"));
}

TEST_F(PointsTest, ADescriptionNamesTheCoordinateSystems) {
  start();
  EXPECT_THAT(get("/api/models/cube"),
              AllOf(HasSubstr("\"coordinate_system\": {\n    \"id\": \"EPSG:25832\",\n    \"name\": \"UTM zone 32N\""),
                    HasSubstr("\"wkt\": \"GEOGCRS[2]\"")));
  EXPECT_THAT(get("/api/models/teapot"), Not(HasSubstr("coordinate_system")));
  auto connection = connect();
  ASSERT_TRUE(connection);
  wire::Request request;
  request.mutable_describe_model()->set_model("cube");
  const auto cube = connection->ask(request);
  ASSERT_TRUE(cube);
  EXPECT_EQ(cube->model_description().system().id(), "EPSG:25832");
  EXPECT_EQ(cube->model_description().source_system().name(), "WGS 84");
  request.mutable_describe_model()->set_model("teapot");
  EXPECT_FALSE(connection->ask(request)->model_description().has_system());
}

TEST_F(PointsTest, AHeadHasNoBody) {
  serve(scan_of(20));
  const std::string answer =
      http("HEAD /api/models/cube/points?format=laz HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(answer, AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("X-Surfcast-Points: 400")));
  EXPECT_TRUE(answer.ends_with("\r\n\r\n"));
}

TEST_F(PointsTest, TheConnectionGoesOnBehindThem) {
  serve(scan_of(20));
  RawSocket socket(port_);
  const std::string request = "GET /api/models/cube/points HTTP/1.1\r\nHost: here\r\n\r\n";
  ASSERT_TRUE(socket.send(request + "GET /healthz HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n"));
  EXPECT_THAT(socket.read_to_end(), AllOf(HasSubstr("0\r\n\r\nHTTP/1.1 200 OK"), HasSubstr("ok\n")));
}

// The client reads nothing until the token is revoked: most of the export has not been made then.
TEST_F(PointsTest, AnExportEndsWithItsToken) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / ("revoked" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::string secret = access::make_secret();
  ServerConfig config;
  config.tokens = folder / "tokens.json";
  config.audit = folder / "audit.log";
  ASSERT_TRUE(
      access::write_tokens(config.tokens, {{.name = "alice", .sha256 = access::sha256(secret), .models = {"*"}}}));
  serve(scan_of(700), {}, config);
  RawSocket socket(port_, /*receive_buffer=*/4096);
  socket.send("GET /api/models/cube/points?format=csv HTTP/1.1\r\nHost: here\r\nAuthorization: Bearer " + secret +
              "\r\n\r\n");
  const std::string begun = socket.read_exactly(4096);
  EXPECT_THAT(begun, StartsWith("HTTP/1.1 200"));
  ASSERT_TRUE(access::write_tokens(config.tokens, {}));
  const auto is_told = [&] {
    std::ifstream stream(config.audit);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    return text.find("the token was revoked") != std::string::npos;
  };
  EXPECT_TRUE(eventually(is_told));
  const std::string rest = socket.read_to_end();
  EXPECT_LT(rest.size(), size_t{20'000'000});
  EXPECT_THAT(rest, Not(EndsWith("0\r\n\r\n")));
  stop();
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace surfcast::net
