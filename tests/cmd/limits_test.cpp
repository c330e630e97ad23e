#include <fstream>
#include <nlohmann/json.hpp>

#include <gmock/gmock.h>

#include "cmd/serve_fixture.h"
#include "net/raw_socket.h"
#include "support/path_of.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// Settings of the programs, as far as what they limit can be seen from outside.
class LimitsTest : public ServeTest {
 protected:
  [[nodiscard]] std::string get(const std::string& target) const {
    net::RawSocket socket(static_cast<uint16_t>(std::stoi(url_.substr(url_.find(':') + 1))));
    socket.send("GET " + target + " HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n");
    return socket.read_http();
  }
  [[nodiscard]] static client::ProgramOutcome run(const std::string& arguments) {
    return client::run_program(path_of("surfcastd") + " " + arguments + " 2>&1");
  }
  [[nodiscard]] std::string other_scan() const {
    std::ofstream(folder_ / "other.xyz") << "0 0 5\n1 0 5\n0 1 5\n1 1 5\n";
    return file("other.xyz");
  }
};

TEST_F(LimitsTest, ALargerPictureIsRefusedWithTheLimit) {
  serve("--max-pixels 3072 --max-side 100 " + scan_.string());
  EXPECT_THAT(get("/api/models/square/image?resolution=64,48"), HasSubstr("HTTP/1.1 200"));
  const std::string pixels = get("/api/models/square/image?resolution=64,49");
  EXPECT_THAT(pixels, HasSubstr("HTTP/1.1 400"));
  EXPECT_THAT(pixels, HasSubstr("resolution: 64,49 is more than 3072 pixels"));
  const std::string side = get("/api/models/square/image?resolution=101,4");
  EXPECT_THAT(side, HasSubstr("resolution: 101,4 is beyond 100 pixels a side"));
}

TEST_F(LimitsTest, ConnectionsBeyondTheLimitAreRefused) {
  serve("--max-connections 1 " + scan_.string());
  net::RawSocket first(static_cast<uint16_t>(std::stoi(url_.substr(url_.find(':') + 1))));
  first.send("GET /healthz HTTP/1.1\r\nHost: here\r\n\r\n");
  ASSERT_THAT(first.read_http(), HasSubstr("HTTP/1.1 200"));
  EXPECT_THAT(get("/api/models"), HasSubstr("too many connections"));
  EXPECT_THAT(get("/healthz"), HasSubstr("HTTP/1.1 200"));
  const client::ProgramOutcome refused = client::run_program(path_of("surfcast") + " ping " + url_ + " 2>&1");
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.output, HasSubstr("the server is busy: too many connections"));
}

TEST_F(LimitsTest, MemoryIsStatedAtTheStartAndInTheMetrics) {
  serve("--gpu-memory 64M --host-memory 32M " + scan_.string());
  EXPECT_THAT(content(folder_ / "log"), HasSubstr("memory: 64M for surfels on the GPU"));
  EXPECT_THAT(content(folder_ / "log"), HasSubstr("32M for decoded blocks"));
  const std::string metrics = get("/metrics");
  EXPECT_THAT(metrics, HasSubstr("surfcast_gpu_memory_budget_bytes 67108864\n"));
  EXPECT_THAT(metrics, HasSubstr("surfcast_host_memory_budget_bytes 33554432\n"));
}

TEST_F(LimitsTest, ASmallGpuMemoryDrawsACoarserPictureThatSaysSo) {
  std::ofstream scan(folder_ / "wall.xyz");
  for (int i = 0; i < 300 * 300; ++i) scan << i % 300 << ' ' << i / 300 << " 0\n";
  scan.close();
  const auto converged = [this](const std::string& flags) {
    const client::ProgramOutcome outcome =
        run("render --cache " + cache() + " " + file("wall.xyz") + " --resolution 300,300 --output " +
            file("wall.png") + " --stats " + file("wall.json") + flags);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    return nlohmann::json::parse(content(file("wall.json")))["converged"].get<bool>();
  };
  EXPECT_FALSE(converged(" --gpu-memory 1M --host-memory 1M --decoders 1"));
  EXPECT_TRUE(converged(""));
}

TEST_F(LimitsTest, TheCacheKeepsToItsSizeButForWhatIsServed) {
  serve(scan_.string());
  ASSERT_TRUE(draws("square"));  // once it is built
  const std::string flags = " --cache " + cache() + " --pixel 1,1 --resolution 4,4";
  ASSERT_EQ(run("pick " + other_scan() + flags).code, 0);
  EXPECT_EQ(cached().size(), 2U);
  ASSERT_EQ(run("pick " + other_scan() + flags + " --cache-size 1").code, 0);
  EXPECT_EQ(cached().size(), 2U) << "one is served and the other in use";
  EXPECT_THAT(get("/api/models/square/image?resolution=8,8"), HasSubstr("HTTP/1.1 200"));
  EXPECT_EQ(end(SIGTERM), 0);
  ASSERT_EQ(run("pick " + other_scan() + flags + " --cache-size 1").code, 0);
  EXPECT_EQ(cached().size(), 1U);
}

TEST_F(LimitsTest, AHealthCheckGivesUpInItsTime) {
  ASSERT_EQ(run("healthcheck --timeout 0.2 --url 127.0.0.1:1").code, 1);
  EXPECT_EQ(run("healthcheck --timeout never").code, 2);
}

}  // namespace
}  // namespace surfcast::cmd
