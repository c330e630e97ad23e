// Compares the channels of pictures that the program draws with picks in the same model.

#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "geometry/camera.h"
#include "model/model_file.h"
#include "pick/pick_surfel.h"
#include "support/path_of.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 400;
constexpr int kHeight = 300;

glm::dvec3 vector_of(const nlohmann::json& values) {
  return {values[0].get<double>(), values[1].get<double>(), values[2].get<double>()};
}

/// The channels of an EXR file by name.
class ExrFile {
 public:
  explicit ExrFile(const fs::path& path) {
    const auto input = OIIO::ImageInput::open(path.string());
    if (!input) return;
    spec_ = input->spec();
    words_.resize(static_cast<size_t>(spec_.width) * spec_.height * spec_.nchannels);
    if (!input->read_image(0, 0, 0, spec_.nchannels, OIIO::TypeDesc::UNKNOWN, words_.data())) words_.clear();
  }

  [[nodiscard]] bool good() const { return !words_.empty(); }
  [[nodiscard]] const std::vector<std::string>& names() const { return spec_.channelnames; }
  [[nodiscard]] uint32_t word(const std::string& name, int x, int y) const {
    const auto channel = static_cast<size_t>(spec_.channelindex(name));
    const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(spec_.width) + static_cast<size_t>(x);
    return words_.at(pixel * static_cast<size_t>(spec_.nchannels) + channel);
  }
  [[nodiscard]] double value(const std::string& name, int x, int y) const {
    return double{std::bit_cast<float>(word(name, x, y))};
  }
  [[nodiscard]] glm::dvec3 vector(const std::string& name, int x, int y) const {
    return {value(name + ".X", x, y), value(name + ".Y", x, y), value(name + ".Z", x, y)};
  }
  [[nodiscard]] glm::dvec3 origin() const {
    glm::dvec3 origin(0);
    EXPECT_TRUE(
        spec_.getattribute("surfcast:origin", OIIO::TypeDesc(OIIO::TypeDesc::DOUBLE, OIIO::TypeDesc::VEC3), &origin.x));
    return origin;
  }

 private:
  OIIO::ImageSpec spec_;
  std::vector<uint32_t> words_;
};

class ChannelsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("channels_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] int run(const std::string& arguments) const {
    const std::string command =
        "cd '" + folder_.string() + "' && '" + path_of("surfcastd") + "' " + arguments + " >out 2>err";
    return std::system(command.c_str());
  }
  [[nodiscard]] std::string error() const { return text_of("err"); }
  [[nodiscard]] std::string text_of(const std::string& name) const {
    std::ifstream stream(folder_ / name, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }
  /// Draws model.surf as picture.exr with these channels. Returns the frame of its camera.
  geometry::CameraFrame render(const std::string& channels, const std::string& more = {}) {
    EXPECT_EQ(run("render model.surf --output picture.exr --stats stats.json --resolution 400,300 --channels " +
                  channels + " " + more),
              0)
        << error();
    const nlohmann::json camera = nlohmann::json::parse(text_of("stats.json"))["camera"];
    return *geometry::make_camera_frame({vector_of(camera["position"]), vector_of(camera["focal_point"]),
                                         vector_of(camera["view_up"]), camera["view_angle"].get<double>()},
                                        kWidth, kHeight);
  }
  /// Compares 1000 random pixels with picks. Returns how many show a surfel.
  int compare(const geometry::CameraFrame& frame) {
    const ExrFile file(folder_ / "picture.exr");
    EXPECT_TRUE(file.good());
    EXPECT_EQ(file.origin(), frame.eye);
    const auto model = model::ModelFile::open(folder_ / "model.surf");
    pick::SourceBlocks blocks(size_t{1} << 30);
    const std::atomic<bool> no{false};
    std::mt19937 random(3);
    int hits = 0;
    for (int i = 0; i < 1000; ++i) {
      const int x = static_cast<int>(random() % kWidth);
      const int y = static_cast<int>(random() % kHeight);
      const auto picked = pick::pick_surfel(*model, {frame, {x + 0.5, y + 0.5}, {}, {}}, blocks, no);
      EXPECT_TRUE(picked);
      EXPECT_EQ(std::isfinite(file.value("Z", x, y)), picked->has_value()) << x << ' ' << y;
      if (!*picked) {
        EXPECT_EQ(file.word("id", x, y), 0xffffffffU);
        EXPECT_EQ(file.vector("N", x, y), glm::dvec3(0));
        EXPECT_TRUE(std::isnan(file.value("P.X", x, y)));
        continue;
      }
      ++hits;
      const kinds::PickedSurfel& surfel = **picked;
      EXPECT_NEAR(file.value("Z", x, y), surfel.depth, 1e-6 * surfel.distance);
      EXPECT_EQ(file.word("id", x, y), surfel.number);
      EXPECT_LT(glm::distance(file.vector("N", x, y), surfel.normal), 1e-6);
      const glm::dvec3 point = frame.to_camera(file.origin() + file.vector("P", x, y));
      EXPECT_LT(glm::distance(point, surfel.depth * frame.ray({x + 0.5, y + 0.5})), 1e-6 * surfel.distance);
      EXPECT_LE(glm::distance(point, frame.to_camera(surfel.position)),
                1.5 * surfel.radius + 2 * surfel.depth / frame.eta);
    }
    return hits;
  }

  fs::path folder_;
};

TEST_F(ChannelsTest, OfTheLionAgreeWithPicks) {
  ASSERT_EQ(run("build '" + path_of("tests/data") + "/lion.drc' --output model.surf"), 0) << error();
  const geometry::CameraFrame frame = render("depth,normal,position,coverage,surfel");
  EXPECT_GT(compare(frame), 150);
  const ExrFile file(folder_ / "picture.exr");
  EXPECT_EQ(file.value("A", 0, 0), 0);
  EXPECT_EQ(file.value("A", kWidth / 2, kHeight / 2), 1);
}

TEST_F(ChannelsTest, FarFromTheOriginAgreeWithPicks) {
  std::ofstream scan(folder_ / "scan.xyz");
  scan.precision(12);
  for (int i = 0; i < 40000; ++i) {
    const double u = 0.05 * (i % 200);
    const double v = 0.05 * (i / 200);
    scan << 1'048'576.5 + u << ' ' << 5'411'932.25 + v << ' ' << 312 + 0.8 * std::sin(u) * std::cos(1.3 * v) << '\n';
  }
  scan.close();
  ASSERT_EQ(run("build scan.xyz --output model.surf"), 0) << error();
  const std::string camera =
      "--camera-position 1048575,5411925,316 --camera-focal-point 1048581,5411937,312 --camera-view-up 0,0,1";
  EXPECT_GT(compare(render("depth,normal,position,surfel", camera)), 300);
}

TEST_F(ChannelsTest, LeaveTheColorsAsTheyAre) {
  ASSERT_EQ(run("build '" + path_of("tests/data") + "/lion.drc' --output model.surf"), 0) << error();
  render("depth,coverage");
  const ExrFile with(folder_ / "picture.exr");
  ASSERT_EQ(run("render model.surf --output plain.exr --resolution 400,300"), 0) << error();
  const ExrFile without(folder_ / "plain.exr");
  EXPECT_EQ(with.names(), (std::vector<std::string>{"R", "G", "B", "A", "Z"}));
  EXPECT_EQ(without.names(), (std::vector<std::string>{"R", "G", "B"}));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (const char* name : {"R", "G", "B"})
        ASSERT_EQ(with.word(name, x, y), without.word(name, x, y)) << x << ' ' << y;
    }
  }
}

TEST_F(ChannelsTest, ThatCannotBeHadAreRefusedInOneLine) {
  std::ofstream(folder_ / "scan.xyz") << "0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
  ASSERT_EQ(run("build scan.xyz --output model.surf"), 0) << error();
  EXPECT_EQ(WEXITSTATUS(run("render model.surf --output a.png --channels depth")), 2);
  EXPECT_EQ(error(), "surfcastd: --channels needs a picture in EXR format\n");
  EXPECT_EQ(WEXITSTATUS(run("render model.surf --output a.exr --channels depth,colour")), 2);
  EXPECT_EQ(WEXITSTATUS(run("render model.surf --output a.exr --channels classification")), 1);
  EXPECT_NE(error().find("channels: the model has no classification"), std::string::npos) << error();
  EXPECT_FALSE(fs::exists(folder_ / "a.exr"));
}

}  // namespace
}  // namespace surfcast::cmd
