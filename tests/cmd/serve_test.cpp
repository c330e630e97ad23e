#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>

#include <sys/stat.h>

#include "cmd/serve_fixture.h"
#include "scan/tile_files.h"
#include "support/path_of.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;

TEST_F(ServeTest, ScansInAFolderOfModelsAreNamedAsNotServed) {
  serve(folder_.string());
  EXPECT_NE(content(folder_ / "log").find("1 scan skipped, such as square.ply: name a scan to build and serve it"),
            std::string::npos)
      << content(folder_ / "log");
}

TEST_F(ServeTest, AScanIsBuiltServedDrawnAndTheServerEndsWhenTold) {
  serve(scan_.string());
  EXPECT_EQ(client::run_program(path_of("surfcast") + " models " + url_).output, "square\n");
  EXPECT_EQ(client::run_program(path_of("surfcastd") + " healthcheck --url " + url_).code, 0);
  const std::string flags = " --resolution 64,48 --output ";
  ASSERT_EQ(client::run_program(path_of("surfcast") + " render " + url_ + "/square" + flags + file("served.png")).code,
            0);
  ASSERT_EQ(client::run_program(path_of("surfcastd") + " render --cache " + cache() + " " + scan_.string() + flags +
                                file("drawn.png") + " --stats " + file("drawn.json") + " 2>&1")
                .code,
            0);
  EXPECT_FALSE(content(file("served.png")).empty());
  EXPECT_TRUE(content(file("served.png")) == content(file("drawn.png")));
  EXPECT_NE(content(file("drawn.json")).find("\"gl_renderer\""), std::string::npos);
  EXPECT_NE(content(file("log")).find("OpenGL"), std::string::npos);
  EXPECT_EQ(end(SIGTERM), 0);
  EXPECT_EQ(client::run_program(path_of("surfcastd") + " healthcheck --url " + url_ + " 2>&1").code, 1);
}

TEST_F(ServeTest, AFolderThatIsAScanIsServedUnderItsName) {
  testing::Bytes points;
  for (int i = 0; i < 400; ++i) points.add(static_cast<float>(i % 20)).add(static_cast<float>(i / 20)).add(0.0F);
  fs::create_directories(folder_ / "church");
  const auto write = [this](const std::string& name, const std::string& text) {
    ASSERT_TRUE(write_file_atomically(folder_ / "church" / name, text));
  };
  write("a.pnts", testing::pnts(R"({"POINTS_LENGTH": 400, "POSITION": {"byteOffset": 0}})", points.text()));
  write("tileset.json", R"({"asset": {"version": "1.0"}, "root": {"content": {"uri": "a.pnts"}}})");
  serve(file("church"));
  EXPECT_EQ(client::run_program(path_of("surfcast") + " models " + url_).output, "church\n");
  ASSERT_TRUE(draws("church"));
  const std::string drawn = content(file("drawn.png"));
  EXPECT_FALSE(drawn.empty());
  EXPECT_EQ(end(SIGTERM), 0);
  serve(file("church/tileset.json"));
  EXPECT_EQ(client::run_program(path_of("surfcast") + " models " + url_).output, "church\n");
  ASSERT_TRUE(draws("church"));
  EXPECT_TRUE(content(file("drawn.png")) == drawn);
}

TEST_F(ServeTest, AFolderOfModelsIsNoScanWhateverElseItHolds) {
  const std::string model = file("models/square.surf");
  fs::create_directories(folder_ / "models");
  ASSERT_EQ(
      client::run_program(path_of("surfcastd") + " build " + scan_.string() + " --output " + model + " 2>&1").code, 0);
  ASSERT_TRUE(write_file_atomically(folder_ / "models/tileset.json", R"({"asset": {}, "root": {}})"));
  serve(file("models"));
  EXPECT_EQ(client::run_program(path_of("surfcast") + " models " + url_).output, "square\n");
}

TEST_F(ServeTest, AReaderOfTheLogThatGoesAwayDoesNotEndTheServer) {
  const std::string pipe = file("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const pid_t reader = client::start_program({"/bin/sh", "-c", "head -n 1 < " + pipe});
  serve(scan_.string(), pipe);
  ASSERT_EQ(client::wait_for_program(reader), 0);
  EXPECT_EQ(get("/healthz"), "ok\n");
  EXPECT_EQ(end(SIGTERM), 0) << "it says that it stops, and nobody reads it";
}

/// The children of a server whose command lines meet a condition.
std::vector<pid_t> children_of(pid_t server, const std::function<bool(const std::string& command)>& is_meant) {
  std::vector<pid_t> children;
  for (const fs::directory_entry& process : fs::directory_iterator("/proc")) {
    const std::string name = process.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string status = content(process.path() / "status");
    const bool child = status.find("\nPPid:\t" + std::to_string(server) + "\n") != std::string::npos;
    if (child && is_meant(content(process.path() / "cmdline"))) children.push_back(std::stoi(name));
  }
  return children;
}

/// One of them; -1: there is none.
pid_t child_of(pid_t server, const std::function<bool(const std::string& command)>& is_meant) {
  const std::vector<pid_t> children = children_of(server, is_meant);
  return children.empty() ? -1 : children.front();
}

/// The process that draws for a server, or that answers for it ("query-worker"); -1: there is none.
pid_t worker_of(pid_t server, const std::string& purpose = "render-worker") {
  return child_of(server, [&](const std::string& command) { return command.find(purpose) != std::string::npos; });
}

TEST_F(ServeTest, ARenderWorkerThatIsKilledIsReplaced) {
  serve(scan_.string());
  ASSERT_TRUE(draws("square"));
  const std::string drawn = content(file("drawn.png"));
  EXPECT_FALSE(drawn.empty());
  for (int kills = 1; kills <= 3; ++kills) {
    const pid_t worker = worker_of(server_);
    ASSERT_GT(worker, 0);
    ::kill(worker, SIGKILL);
    const client::ProgramOutcome outcome = draw("square");
    ASSERT_EQ(outcome.code, 0) << outcome.output;
    EXPECT_TRUE(content(file("drawn.png")) == drawn);
  }
  EXPECT_NE(get("/metrics").find("\nsurfcast_workers_ended_total 3\n"), std::string::npos);
}

/// One software device stands for two GPUs.
TEST_F(ServeTest, TwoGpusHaveAWorkerEachAndDrawAllModels) {
  const std::string devices = client::run_program(path_of("surfcastd") + " gpus").output;
  if (devices.starts_with("EGL lists no devices")) GTEST_SKIP() << devices;
  ASSERT_TRUE(devices.starts_with("0 software: ") || devices.starts_with("0 hardware: ")) << devices;
  std::string scans;
  for (const char* const name : {"a", "b", "c", "d", "e", "f"}) {
    const fs::path scan = folder_ / (std::string(name) + ".ply");
    fs::copy_file(scan_, scan);
    scans += " " + scan.string();
  }
  serve("--gpu 0,0 --gpu-memory 64M --host-memory 64M" + scans);
  const auto workers = [this] {
    return children_of(server_, [](const auto& command) { return command.find("render-worker") != std::string::npos; });
  };
  ASSERT_EQ(workers().size(), 2U);
  const std::string metrics = get("/metrics");
  EXPECT_NE(metrics.find("\nsurfcast_gpu_memory_budget_bytes 134217728\n"), std::string::npos) << "of each";
  EXPECT_NE(metrics.find("\nsurfcast_host_memory_budget_bytes 67108864\n"), std::string::npos) << "of both";
  ASSERT_TRUE(draws("a"));
  const std::string drawn = content(file("drawn.png"));
  const std::string render = "SURFCAST_GPU=0,0 " + path_of("surfcastd") + " render --cache " + cache() + " ";
  EXPECT_EQ(client::run_program(render + scan_.string() + " --resolution 8,8 --output " + file("alone.png")).code, 0)
      << "with the variable of the server";
  for (const pid_t worker : workers()) ::kill(worker, SIGKILL);
  for (const char* const name : {"b", "c", "d", "e", "f", "a"}) {
    ASSERT_TRUE(draws(name));
    EXPECT_TRUE(content(file("drawn.png")) == drawn) << name;
  }
  EXPECT_EQ(workers().size(), 2U) << "each has drawn some";
  EXPECT_EQ(end(SIGTERM), 0);
}

TEST_F(ServeTest, AQueryWorkerThatIsKilledIsReplacedAndAnswersAsTheServerWould) {
  serve(scan_.string());
  const std::string pick = "/api/models/square/pick?pixel=32,24&resolution=64,48";
  const std::string profile = "/api/models/square/profile?line=2,3.2,0;12.5,3.2,9&width=1&format=csv";
  const std::string region = "/api/models/square/points?box=2,2,-1,9,9,1&format=csv";
  std::string picked = get(pick);
  EXPECT_NE(picked.find("\"position\""), std::string::npos) << picked;
  const std::string profiled = get(profile);
  const std::string points = get(region);
  for (int kills = 1; kills <= 3; ++kills) {
    const pid_t worker = worker_of(server_, "query-worker");
    ASSERT_GT(worker, 0);
    ::kill(worker, SIGKILL);
    EXPECT_EQ(get(pick), picked);
    EXPECT_EQ(get(profile), profiled);
    EXPECT_EQ(get(region), points);
  }
  EXPECT_NE(get("/metrics").find("\nsurfcast_query_workers_ended_total 3\n"), std::string::npos);
  EXPECT_NE(get("/metrics").find("\nsurfcast_query_blocks_quarantined_total 0\n"), std::string::npos);
  EXPECT_EQ(end(SIGTERM), 0);
  serve("--workers 0 " + scan_.string());
  EXPECT_EQ(worker_of(server_, "query-worker"), -1);
  EXPECT_EQ(get(pick), picked);
  EXPECT_EQ(get(profile), profiled);
  EXPECT_EQ(get(region), points);
}

/// Bytes that a process has read from files so far.
uint64_t bytes_read(pid_t process) {
  const std::string counts = content(fs::path("/proc") / std::to_string(process) / "io");
  return counts.starts_with("rchar: ") ? std::stoull(counts.substr(7)) : 0;
}

TEST_F(ServeTest, AServerWithWorkersReadsNoBlocks) {
  constexpr uint64_t kLessThanABlock = 10'000;  // and more than what else it reads
  std::ofstream points(folder_ / "dense.xyz");
  for (int i = 0; i < 40'000; ++i) points << i % 200 << ' ' << i / 200 << ' ' << i * 7919 % 1009 * 0.001 << '\n';
  points.close();
  const std::vector<std::string> questions{
      "/api/models/dense/pick?pixel=32,24&resolution=64,48",
      "/api/models/dense/profile?line=0,90,0;199,100,0&width=400&format=las",
      "/api/models/dense/points?box=0,0,-1,199,199,2&format=las",
      "/api/models/dense/image?resolution=64,48&format=exr&channels=depth",
  };
  std::vector<std::string> answers;
  for (const std::string workers : {"1", "0"}) {
    serve("--workers " + workers + " " + (folder_ / "dense.xyz").string());
    ASSERT_TRUE(draws("dense"));
    EXPECT_FALSE(get("/api/models/dense/image?resolution=8,8&format=exr").empty());  // loads the codec
    if (bytes_read(server_) == 0) GTEST_SKIP() << "the kernel does not count what is read";
    for (size_t i = 0; i < questions.size(); ++i) {
      const uint64_t before = bytes_read(server_);
      const std::string answer = get(questions[i]);
      const uint64_t read = bytes_read(server_) - before;
      if (workers == "1") {
        EXPECT_LT(read, kLessThanABlock) << questions[i];
        answers.push_back(answer);
      } else {
        EXPECT_GT(read, kLessThanABlock) << questions[i];
        EXPECT_TRUE(answer == answers[i]) << questions[i];
      }
    }
    EXPECT_EQ(end(SIGTERM), 0);
  }
}

TEST_F(ServeTest, AServerWithoutWorkersDrawsTheSamePictures) {
  serve(scan_.string());
  ASSERT_TRUE(draws("square"));
  const std::string drawn = content(file("drawn.png"));
  EXPECT_EQ(end(SIGTERM), 0);
  serve("--workers 0 " + scan_.string());
  EXPECT_EQ(worker_of(server_), -1);
  ASSERT_TRUE(draws("square"));
  EXPECT_TRUE(content(file("drawn.png")) == drawn);
  EXPECT_EQ(get("/metrics").find("surfcast_workers"), std::string::npos);
}

TEST_F(ServeTest, WorkersEndWithTheirServer) {
  serve(scan_.string());
  ASSERT_TRUE(draws("square"));
  const std::array workers{worker_of(server_), worker_of(server_, "query-worker")};
  for (const pid_t worker : workers) ASSERT_GT(worker, 0);
  end(SIGKILL);
  for (const pid_t worker : workers) {
    const fs::path process = fs::path("/proc") / std::to_string(worker);
    for (int i = 0; i < 3000 && fs::exists(process) && content(process / "status").find("\tZ") == std::string::npos;
         ++i) {
      ::usleep(10'000);
    }
    const std::string status = content(process / "status");
    EXPECT_TRUE(status.empty() || status.find("Z (zombie)") != std::string::npos) << status;
  }
}

TEST_F(ServeTest, ChannelsAreTheSameByEveryWay) {
  serve(scan_.string());
  const std::string flags = " --resolution 64,48 --channels depth,normal,position,coverage,surfel --output ";
  const std::string program = path_of("surfcast") + " render ";
  EXPECT_EQ(client::run_program(program + url_ + "/square" + flags + file("tcp.exr")).code, 0);
  EXPECT_EQ(client::run_program(program + "ws://" + url_ + "/square" + flags + file("ws.exr")).code, 0);
  const std::string fetched =
      get("/api/models/square/image?resolution=64,48&format=exr&"
          "channels=depth,normal,position,coverage,surfel");
  EXPECT_EQ(client::run_program(path_of("surfcastd") + " render --cache " + cache() + " " + scan_.string() + flags +
                                file("drawn.exr") + " 2>&1")
                .code,
            0);
  const std::string drawn = content(file("drawn.exr"));
  EXPECT_NE(drawn.find("P.Z"), std::string::npos);
  for (const char* name : {"tcp.exr", "ws.exr"}) EXPECT_TRUE(content(file(name)) == drawn) << name;
  EXPECT_TRUE(fetched == drawn);
}

TEST_F(ServeTest, AProfileIsTheSameByEveryWay) {
  serve(scan_.string());
  const std::string flags = " --line '2,3.2,0;12.5,3.2,9' --width 1 --output ";
  const std::string program = path_of("surfcast") + " profile ";
  for (const std::string format : {"csv", "las"}) {
    EXPECT_EQ(client::run_program(program + url_ + "/square" + flags + file("tcp." + format)).code, 0);
    EXPECT_EQ(client::run_program(program + "ws://" + url_ + "/square" + flags + file("ws." + format)).code, 0);
    EXPECT_FALSE(content(file("tcp." + format)).empty());
    EXPECT_TRUE(content(file("tcp." + format)) == content(file("ws." + format)));
    EXPECT_TRUE(content(file("tcp." + format)) ==
                get("/api/models/square/profile?line=2,3.2,0;12.5,3.2,9&width=1&format=" + format));
  }
  // The points from x = 2 to 12 at y = 3; the band ends at 2.7 and 3.7.
  const std::string header = "x,y,z,along,across,red,green,blue\r\n";
  const std::string csv = content(file("tcp.csv"));
  EXPECT_TRUE(csv.starts_with(header)) << csv;
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 12);
  EXPECT_NE(csv.find("\r\n2,3,0,0,-0."), std::string::npos) << csv;
  EXPECT_NE(csv.find("\r\n12,3,0,10,-0."), std::string::npos) << csv;
  const client::ProgramOutcome sample =
      client::run_program(program + url_ + "/square" + flags + file("few.csv") + " --max-points 4 2>&1");
  EXPECT_EQ(sample.output, "surfcast: an even sample: 4 of 11 points\n");
  for (const std::string wrong :
       {"--line '1,2,3' --width 1", "--line '1,2,3;4,5,6' --width 0", "--line '1,2,3;4,5,6' --width 1 --format laz"}) {
    EXPECT_EQ(client::run_program(program + url_ + "/square " + wrong + " --output " + file("a.csv") + " 2>&1").code,
              2);
  }
}

TEST_F(ServeTest, ARegionIsTheSameByEveryWay) {
  serve("--max-region-points 300 " + scan_.string());
  const std::string program = path_of("surfcast") + " export ";
  const std::string flags = " --box '2,3,-1,12.5,7,1' --output ";
  for (const std::string format : {"las", "laz", "ply", "csv", "npy"}) {
    const client::ProgramOutcome saved =
        client::run_program(program + url_ + "/square" + flags + file("tcp." + format) + " 2>&1");
    EXPECT_EQ(saved.code, 0) << saved.output;
    EXPECT_EQ(saved.output, "55 points\n");
    EXPECT_EQ(client::run_program(program + "ws://" + url_ + "/square" + flags + file("ws." + format)).code, 0);
    EXPECT_FALSE(content(file("tcp." + format)).empty());
    EXPECT_TRUE(content(file("tcp." + format)) == content(file("ws." + format)));
    std::string streamed =
        client::run_program(program + url_ + "/square --bounds '2,3,-1,12.5,7,1' --output - --format " + format).output;
    if (format == "laz") {  // a file states the place of the chunk table before its points, a stream at its end
      uint32_t points = 0;
      std::memcpy(&points, streamed.data() + 96, sizeof points);
      EXPECT_EQ(streamed.substr(points, 8), std::string(8, '\xff'));
      streamed.replace(points, 8, streamed.substr(streamed.size() - 8));
    }
    EXPECT_EQ(streamed, content(file("tcp." + format)));
  }
  const std::string csv = content(file("tcp.csv"));
  EXPECT_TRUE(csv.starts_with("x,y,z,red,green,blue\n")) << csv;
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 56);
  EXPECT_NE(csv.find("\n12,3,0,200,100,50\n"), std::string::npos) << csv;
  EXPECT_EQ(client::run_program(program + url_ + "/square --count").output, "400\n");
  EXPECT_EQ(client::run_program(program + url_ + "/square --count --corridor 2,0,5,19,5").output, "60\n");
}

TEST_F(ServeTest, SeveralModelsAreShownAsOne) {
  const auto build = [&](const std::string& name, int east) {
    std::ostringstream text;
    text << "x,y,z,red,green,blue\n";
    for (int i = 0; i < 400; ++i) text << east + i % 20 << ',' << i / 20 << ",0,200,100,50\n";
    ASSERT_TRUE(write_file_atomically(folder_ / (name + ".csv"), text.str()));
    ASSERT_EQ(client::run_program(path_of("surfcastd") + " build " + file(name + ".csv") + " --output " +
                                  file(name + ".surf"))
                  .code,
              0);
  };
  build("west", 0);
  build("east", 20);
  build("a+b", 40);
  serve(file("west.surf") + " " + file("east.surf") + " " + file("a+b.surf"));

  // The same picture by every way, and another one than of either model.
  const std::string camera = "position=20,10,60&focal_point=20,10,0&view_up=0,1,0&resolution=96,64";
  const std::string flags =
      " --camera-position 20,10,60 --camera-focal-point 20,10,0 --camera-view-up 0,1,0 --resolution 96,64 --output ";
  const std::string over_http = get("/api/models/west+east/image?" + camera);
  ASSERT_EQ(over_http.substr(1, 3), "PNG") << over_http;
  ASSERT_EQ(
      client::run_program(path_of("surfcast") + " render " + url_ + "/west+east" + flags + file("framed.png")).code, 0);
  EXPECT_EQ(content(folder_ / "framed.png"), over_http);
  for (const std::string& files :
       {file("west.surf") + "+" + file("east.surf"), file("west.surf") + " " + file("east.surf")}) {
    const auto local =
        client::run_program(path_of("surfcastd") + " render " + files + flags + file("local.png") + " 2>&1");
    ASSERT_EQ(local.code, 0) << local.output;
    EXPECT_EQ(content(folder_ / "local.png"), over_http);
  }
  const std::string west = get("/api/models/west/image?" + camera);
  EXPECT_NE(west, over_http);
  EXPECT_EQ(get("/api/models/west+east/image?hide_models=east&" + camera), west);

  // Descriptions, picks and points.
  const auto description = nlohmann::json::parse(get("/api/models/west+east"));
  EXPECT_EQ(description["surfels"], 800);
  ASSERT_EQ(description["members"].size(), 2U);
  EXPECT_EQ(description["members"][1]["model"], "east");
  EXPECT_EQ(description["members"][1]["bounds"]["min"][0], 20);
  const auto picked = nlohmann::json::parse(get("/api/models/west+east/pick?pixel=60,32&" + camera));
  ASSERT_EQ(picked["hit"], true) << picked;
  EXPECT_EQ(picked["model"], "east");
  const std::string hidden = get("/api/models/west+east/pick?pixel=60,32&hide_models=east&" + camera);
  EXPECT_EQ(nlohmann::json::parse(hidden)["hit"], false);
  EXPECT_EQ(nlohmann::json::parse(get("/api/models/west+east/points?count=1"))["points"], 800);
  const auto pick = client::run_program(path_of("surfcastd") + " pick " + file("west.surf") + " " + file("east.surf") +
                                        " --pixel 60,32 --json --camera-position 20,10,60 --camera-focal-point "
                                        "20,10,0 --camera-view-up 0,1,0 --resolution 96,64");
  ASSERT_EQ(pick.code, 0) << pick.output;
  EXPECT_EQ(nlohmann::json::parse(pick.output)["model"], "east");

  // A model of exactly that name, models that are not there, and one twice.
  EXPECT_EQ(nlohmann::json::parse(get("/api/models/a+b"))["surfels"], 400);
  ASSERT_EQ(client::run_program(path_of("surfcastd") + " render " + file("a+b.surf") + flags + file("plus.png")).code,
            0);
  EXPECT_NE(get("/api/models/west+south").find("there is no model 'south'"), std::string::npos);
  EXPECT_NE(get("/api/models/west+west").find("west: is named twice"), std::string::npos);
}

TEST_F(ServeTest, ARegionThatFailsLeavesNoFile) {
  serve("--max-region-points 300 " + scan_.string());
  const std::string program = path_of("surfcast") + " export " + url_ + "/square --output " + file("part.csv");
  const client::ProgramOutcome large = client::run_program(program + " 2>&1");
  EXPECT_EQ(large.code, 1);
  EXPECT_NE(large.output.find("the region has more than 300 points"), std::string::npos) << large.output;
  const client::ProgramOutcome empty = client::run_program(program + " --box '0.1,0.1,0,0.2,0.2,0' 2>&1");
  EXPECT_EQ(empty.code, 1);
  EXPECT_NE(empty.output.find("has no points in the region"), std::string::npos) << empty.output;
  for (const std::string wrong : {"--box 1,2,3", "--box 1,0,0,0,1,1", "--box nan,0,0,1,1,1", "--format e57", "--count",
                                  "--classes 256", "--every 0", "--corridor 1,0,0"}) {
    EXPECT_EQ(client::run_program(program + " " + wrong + " 2>&1").code, 2) << wrong;
  }
  EXPECT_FALSE(fs::exists(file("part.csv")));
}

TEST_F(ServeTest, AScanIsBuiltOnceHoweverItIsNamed) {
  serve(scan_.string());
  ASSERT_TRUE(draws("square"));  // once it is built
  EXPECT_EQ(end(SIGINT), 0);
  const fs::path copy = folder_ / "renamed.ply";
  fs::copy_file(scan_, copy);
  serve(copy.string());
  EXPECT_EQ(client::run_program(path_of("surfcast") + " models " + url_).output, "renamed\n");
  EXPECT_EQ(content(file("log")).find("building"), std::string::npos);
  EXPECT_EQ(cached().size(), 1U);
}

TEST_F(ServeTest, AVolumeWithItsSamplesInAnotherFileIsBuiltAndDrawn) {
  std::ofstream(folder_ / "ball.mhd") << "ObjectType = Image\nNDims = 3\nDimSize = 20 20 20\n"
                                         "ElementType = MET_UCHAR\nElementDataFile = ball.raw\n";
  std::string samples;
  for (int i = 0; i < 8000; ++i) {
    const double r = std::hypot(i % 20 - 9.5, i / 20 % 20 - 9.5, i / 400 - 9.5);
    samples += static_cast<char>(std::max(0.0, 200 - 20 * r));
  }
  std::ofstream(folder_ / "ball.raw", std::ios::binary) << samples;
  serve("--preview-points 100 --preview-from 1K " + file("ball.mhd"));
  EXPECT_TRUE(draws("ball"));
  EXPECT_NE(get("/api/models/ball").find("\"grid\""), std::string::npos);
  EXPECT_EQ(end(SIGTERM), 0);
}

TEST_F(ServeTest, WhatCannotBeServedIsAFailureThatNamesIt) {
  ASSERT_TRUE(write_file_atomically(folder_ / "broken.ply", "ply\nformat ascii 1.0\n"));
  for (const std::string name : {"absent.surf", "absent.ply", "broken.ply"}) {
    const client::ProgramOutcome outcome = client::run_program(
        path_of("surfcastd") + " serve --listen 127.0.0.1:0 --cache " + cache() + " " + file(name) + " 2>&1");
    EXPECT_EQ(outcome.code, 1) << name;
    EXPECT_NE(outcome.output.find("surfcastd: "), std::string::npos);
    EXPECT_NE(outcome.output.find(name), std::string::npos) << outcome.output;
  }
}

TEST_F(ServeTest, AScanThatCannotBeBuiltIsListedWithItsReasonAndOthersAreServed) {
  ASSERT_TRUE(write_file_atomically(folder_ / "broken.ply", square_of_points().substr(0, 400)));
  serve(file("broken.ply") + " " + scan_.string());
  EXPECT_TRUE(draws("square"));
  const std::string list = list_until("\"state\": \"failed\"");
  EXPECT_NE(list.find("broken.ply: truncated"), std::string::npos) << list;
  EXPECT_EQ(client::run_program(path_of("surfcast") + " models " + url_).output, "square\n");
  EXPECT_NE(draw("broken").code, 0);
  EXPECT_EQ(end(SIGTERM), 0);
}

/// A scan of whose model the build takes a while.
class ServeLargeScanTest : public ServeTest {
 protected:
  void SetUp() override {
    ServeTest::SetUp();
    std::ofstream stream(large_ = folder_ / "large.xyz");
    for (int i = 0; i < 1'500'000; ++i) stream << i % 1500 << ' ' << i / 1500 << ' ' << (i % 1500) * (i % 7) << '\n';
  }

  /// Waits until the model is being built, and returns the process. Those that make previews take samples.
  [[nodiscard]] pid_t building() const {
    for (int i = 0; i < 3000; ++i) {
      const pid_t process = child_of(server_, [](const std::string& command) {
        return command.find("--background") != std::string::npos && command.find("--sample") == std::string::npos;
      });
      if (process > 0) return process;
      ::usleep(10'000);
    }
    return -1;
  }

  fs::path large_;
};

TEST_F(ServeLargeScanTest, ThePortIsOpenAtOnceAndAPreviewIsServedWhileTheModelIsBuilt) {
  serve("--build-threads 1 --preview-points 20000 " + large_.string());
  EXPECT_EQ(client::run_program(path_of("surfcast") + " models " + url_).output, "large\n");
  const pid_t build = building();
  ASSERT_GT(build, 0);
  ::kill(build, SIGSTOP);  // or it might be done before the preview is drawn
  const std::string list = list_until("\"preview\": true");
  EXPECT_NE(list.find("\"percent\""), std::string::npos) << list;
  EXPECT_NE(list.find("\"seconds_left\""), std::string::npos) << list;
  EXPECT_TRUE(draws("large"));
  ::kill(build, SIGCONT);
  EXPECT_EQ(end(SIGTERM), 0) << "the build is given up";
  EXPECT_TRUE(cached().empty()) << "and leaves nothing behind";
}

TEST_F(ServeTest, WhatKilledServersLeftInTheCacheIsRemoved) {
  fs::create_directories(folder_ / "cache" / "preview-a1b2c3");
  for (const char* name : {"cache/preview-a1b2c3/preview.surf.tmp7-1", "cache/model.surf.tmp7-2", "cache/mine.txt"}) {
    ASSERT_TRUE(write_file_atomically(folder_ / name, "left"));
  }
  serve(scan_.string());
  ASSERT_TRUE(draws("square"));
  EXPECT_FALSE(fs::exists(folder_ / "cache" / "preview-a1b2c3"));
  EXPECT_FALSE(fs::exists(folder_ / "cache" / "model.surf.tmp7-2"));
  EXPECT_TRUE(fs::exists(folder_ / "cache" / "mine.txt"));
}

/// A server that takes scans.
class ServeUploadsTest : public ServeTest {
 protected:
  void SetUp() override {
    ServeTest::SetUp();
    fs::create_directories(uploads());
    serve_uploads();
  }
  void serve_uploads() { serve(scan_.string() + " --uploads " + uploads()); }
  [[nodiscard]] std::string uploads() const { return file("uploads"); }
  /// The server's answer to a scan that is sent.
  [[nodiscard]] std::string put(const std::string& name, const std::string& body) const {
    net::RawSocket socket(static_cast<uint16_t>(std::stoi(url_.substr(url_.find(':') + 1))));
    socket.send("PUT /api/uploads/" + name +
                " HTTP/1.1\r\nHost: here\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
    return socket.read_http();
  }
};

TEST_F(ServeUploadsTest, AScanThatIsSentIsBuiltAndServedByLaterServersToo) {
  EXPECT_NE(put("Sent.PLY", square_of_points()).find("201 Created"), std::string::npos);
  EXPECT_TRUE(draws("Sent"));
  ASSERT_TRUE(write_file_atomically(file("uploads/half.ply.tmp7-1"), "left by a server that was killed"));
  EXPECT_EQ(end(SIGTERM), 0);
  serve_uploads();
  EXPECT_EQ(client::run_program(path_of("surfcast") + " models " + url_).output, "Sent\nsquare\n");
  EXPECT_TRUE(draws("Sent"));
  EXPECT_EQ(std::distance(fs::directory_iterator(uploads()), fs::directory_iterator()), 1);
}

TEST_F(ServeUploadsTest, WhatIsNoScanOrHasANameThatIsTakenIsRefused) {
  const std::string garbage = put("garbage.laz", "no scan");
  EXPECT_NE(garbage.find("\"garbage.laz: "), std::string::npos) << garbage;
  const std::string torn = put("torn.ply", square_of_points().substr(0, 400));
  EXPECT_NE(torn.find("\"torn.ply: truncated"), std::string::npos) << torn;
  EXPECT_NE(put("square.ply", square_of_points()).find("that name already"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(uploads()));
  EXPECT_EQ(client::run_program(path_of("surfcast") + " models " + url_).output, "square\n");
}

TEST_F(ServeUploadsTest, AScanThatCannotBeBuiltIsListedWithItsReason) {
  EXPECT_NE(put("torn.xyz", "1 2 3\n4 5\n").find("201 Created"), std::string::npos);
  const std::string list = list_until("\"state\": \"failed\"");
  EXPECT_NE(list.find("torn.xyz: line 2"), std::string::npos) << list;
}

TEST_F(ServeTest, WrongCommandLinesEndWithTwo) {
  for (const std::string arguments : {"serve --listen nowhere", "serve --gpu -1", "serve --gpu 0,", "serve --gpu some",
                                      "render a.surf", "render a.surf --output a.gif", "healthcheck --url x"}) {
    EXPECT_EQ(client::run_program(path_of("surfcastd") + " " + arguments + " 2>&1").code, 2) << arguments;
  }
}

}  // namespace
}  // namespace surfcast::cmd
