// The same request gives the same bytes on one device, independently of earlier pictures, of the order in which blocks
// arrive, and of the number of threads. Concurrent operations are sums of integers and maxima of depths, which do not
// depend on the order. The renderer has no other concurrent writes to a picture.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "client/run_program.h"
#include "model/write_model.h"
#include "numerics/sample_pictures.h"
#include "render/renderer.h"
#include "support/clouds.h"
#include "support/path_of.h"

namespace surfcast::testing {
namespace {

using ModelPointer = std::shared_ptr<const model::ModelFile>;

class DeterminismGLTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) / ("surfcast_determinism_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    start({});
  }
  void TearDown() override {
    renderer_.reset();
    std::filesystem::remove_all(folder_);
  }

  /// Replaces the renderer by a new one.
  void start(const render::RendererConfig& config) {
    renderer_.reset();
    Result<std::unique_ptr<render::Renderer>> created = render::Renderer::create(config);
    ASSERT_TRUE(created) << created.error().message;
    renderer_ = std::move(*created);
  }
  ModelPointer model_of(const std::string& name, const surfel::SurfelCloud& cloud) {
    const std::filesystem::path path = folder_ / (name + ".surf");
    if (!std::filesystem::exists(path)) {
      EXPECT_TRUE(model::write_model(cloud, path, {}));
    }
    Result<model::ModelFile> opened = model::ModelFile::open(path);
    EXPECT_TRUE(opened);
    return std::make_shared<const model::ModelFile>(std::move(*opened));
  }
  ModelPointer model_of(const SampleMedium& sample) {
    const std::filesystem::path path = folder_ / (sample.name + ".surf");
    EXPECT_TRUE(std::filesystem::exists(path) || sample.build(path)) << sample.name;
    Result<model::ModelFile> opened = model::ModelFile::open(path);
    EXPECT_TRUE(opened);
    return std::make_shared<const model::ModelFile>(std::move(*opened));
  }
  picture::Frame draw(const ModelPointer& model, const picture::PictureRequest& request) {
    const std::atomic<bool> cancelled{false};
    Result<picture::Frame> frame = renderer_->draw(model, request, cancelled);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
    return frame ? std::move(*frame) : picture::Frame{};
  }
  std::vector<uint64_t> draw_all(const std::vector<SamplePicture>& samples) {
    std::vector<uint64_t> hashes;
    for (const SamplePicture& sample : samples) {
      hashes.push_back(hash_of(draw(model_of(sample.name, sample.cloud), sample.request).image));
    }
    return hashes;
  }
  std::vector<uint64_t> draw_media() {
    std::vector<uint64_t> hashes;
    for (const SampleMedium& sample : sample_media()) {
      const picture::Frame frame = draw(model_of(sample), sample.request);
      EXPECT_TRUE(frame.converged) << sample.name;
      hashes.push_back(hash_of(frame.image));
    }
    return hashes;
  }

  std::filesystem::path folder_;
  std::unique_ptr<render::Renderer> renderer_;
};

/// A model with many blocks on several levels.
surfel::SurfelCloud large_globe() {
  surfel::SurfelCloud cloud = fibonacci_sphere(150000, 1, {0, 0, 0}, {0, 0, 0});
  for (size_t i = 0; i < cloud.size(); ++i) cloud.colors->values[i] = glm::u16vec3(i % 256, i * 7 % 256, i * 31 % 256);
  return cloud;
}

picture::PictureRequest globe_view(double angle, double spacing) {
  picture::PictureRequest request;
  request.camera = geometry::Camera{{2.2 * std::cos(angle), 2.2 * std::sin(angle), 0.7}, {0, 0, 0}, {0, 0, 1}, 40};
  request.width = 200;
  request.height = 150;
  request.spacing = spacing;
  return request;
}

TEST_F(DeterminismGLTest, PicturesInAnotherOrderAreTheSame) {
  std::vector<SamplePicture> samples = sample_pictures();
  const std::vector<uint64_t> first = draw_all(samples);
  EXPECT_EQ(draw_all(samples), first) << "again";
  std::reverse(samples.begin(), samples.end());
  std::vector<uint64_t> backwards = draw_all(samples);
  std::reverse(backwards.begin(), backwards.end());
  EXPECT_EQ(backwards, first) << "backwards";
}

TEST_F(DeterminismGLTest, AFreshRendererDrawsTheSame) {
  const std::vector<SamplePicture> samples = sample_pictures();
  const std::vector<uint64_t> first = draw_all(samples);
  start({});
  EXPECT_EQ(draw_all(samples), first);
}

TEST_F(DeterminismGLTest, VolumesAndGaussiansAreTheSameAgainAndByAFreshRenderer) {
  const std::vector<uint64_t> first = draw_media();
  EXPECT_EQ(draw_media(), first) << "again";
  start({});
  EXPECT_EQ(draw_media(), first) << "by a fresh renderer";
}

TEST_F(DeterminismGLTest, VolumesAndGaussiansWhoseBlocksWereDrivenOutAreTheSame) {
  const std::vector<uint64_t> expected = draw_media();
  render::RendererConfig small;
  small.gpu_bytes = size_t{6} << 20;
  small.host_bytes = 0;
  start(small);
  const ModelPointer evicting = model_of("large", large_globe());
  for (int round = 0; round < 3; ++round) {
    draw(evicting, globe_view(round, 1));
    EXPECT_EQ(draw_media(), expected) << "round " << round;
  }
}

TEST_F(DeterminismGLTest, OtherProcessesAndNumbersOfThreadsDrawTheSame) {
  std::string expected;
  const auto expect = [&](const std::string& name, const picture::Frame& frame) {
    std::array<char, 100> line{};
    std::snprintf(line.data(), line.size(), "%s %016llx\n", name.c_str(),
                  static_cast<unsigned long long>(hash_of(frame.image)));
    expected += line.data();
  };
  for (const SamplePicture& sample : sample_pictures()) {
    expect(sample.name, draw(model_of(sample.name, sample.cloud), sample.request));
  }
  for (const SampleMedium& sample : sample_media()) expect(sample.name, draw(model_of(sample), sample.request));
  renderer_.reset();
  for (const char* threads : {"0", "1", "3"}) {  // only llvmpipe reads this variable
    const client::ProgramOutcome other = client::run_program("LP_NUM_THREADS=" + std::string(threads) + " '" +
                                                             path_of("print_hashes") + "' '" + folder_.string() + "'");
    EXPECT_EQ(other.code, 0);
    EXPECT_EQ(other.output, expected) << threads << " threads";
  }
}

TEST_F(DeterminismGLTest, BlocksThatCameInAnotherOrderOrBackAgainMakeNoDifference) {
  const surfel::SurfelCloud cloud = large_globe();
  const picture::PictureRequest request = globe_view(0.3, 1);
  const uint64_t expected = hash_of(draw(model_of("large", cloud), request).image);
  const surfel::SurfelCloud other = fibonacci_sphere(150000, 1, {0, 0, 0}, {9, 9, 9});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> angle(0, 6.28);
  // GPU memory holds a part of one model only, and host memory nothing, so that every picture evicts blocks.
  render::RendererConfig small;
  small.gpu_bytes = size_t{6} << 20;
  small.host_bytes = 0;
  start(small);
  const ModelPointer large = model_of("large", cloud);
  const ModelPointer evicting = model_of("other", other);
  for (int round = 0; round < 4; ++round) {
    for (int i = 0; i < 3; ++i) draw(large, globe_view(angle(random), 1.5));
    draw(evicting, globe_view(angle(random), 1));
    const picture::Frame frame = draw(large, request);
    ASSERT_TRUE(frame.converged);
    EXPECT_EQ(hash_of(frame.image), expected) << "round " << round;
  }
}

TEST_F(DeterminismGLTest, AViewThatComesToRestShowsWhatASinglePictureDoes) {
  const surfel::SurfelCloud cloud = large_globe();
  const uint64_t expected = hash_of(draw(model_of("large", cloud), globe_view(0.3, 1)).image);
  for (const uint64_t viewer : {1, 2}) {
    start({});
    const ModelPointer model = model_of("large", cloud);
    picture::PictureRequest request = globe_view(0, 1);
    request.loading = picture::Loading::kNow;
    request.viewer = viewer;
    // Turns towards the view, from a different direction for each viewer, then waits for the remaining blocks.
    for (int k = 10; k > 0; --k) {
      request.camera = globe_view(0.3 + 0.1 * k * static_cast<double>(viewer), 1).camera;
      draw(model, request);
    }
    request.camera = globe_view(0.3, 1).camera;
    picture::Frame frame = draw(model, request);
    for (int k = 0; k < 2000 && !frame.converged; ++k) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      frame = draw(model, request);
    }
    ASSERT_TRUE(frame.converged);
    EXPECT_EQ(hash_of(frame.image), expected) << "viewer " << viewer;
  }
}

}  // namespace
}  // namespace surfcast::testing
