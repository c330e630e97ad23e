// Pictures with blocks of different levels: block boundaries must be invisible.

#include <algorithm>
#include <cmath>
#include <future>

#include "render/gl_fixture.h"
#include "support/clouds.h"

namespace surfcast::render {
namespace {

constexpr glm::u8vec3 kColor{200, 120, 40};

class LevelsGLTest : public testing::RendererFixture {
 protected:
  static uint32_t levels_drawn(const picture::Frame& frame) {
    return static_cast<uint32_t>(
        std::ranges::count_if(frame.stats.levels, [](const picture::LevelStats& level) { return level.drawn > 0; }));
  }

  /// Marks the pixels whose neighbourhood of three pixels is fully covered by the finest level: the model's interior.
  static std::vector<bool> interior(const picture::Image& image) {
    constexpr int kBorder = 3;
    std::vector<bool> inside(static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
    for (int y = kBorder; y < image.height - kBorder; ++y) {
      for (int x = kBorder; x < image.width - kBorder; ++x) {
        bool covered = true;
        for (int j = -kBorder; j <= kBorder; ++j) {
          for (int i = -kBorder; i <= kBorder; ++i) covered = covered && pixel(image, x + i, y + j).a == 255;
        }
        inside[static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x)] = covered;
      }
    }
    return inside;
  }

  /// Draws a model of one colour at spacings that mix its levels, with both normalisations. In the model's interior
  /// every pixel must have this colour, as at the finest level.
  static void expect_no_seams(const testing::ModelPointer& model, picture::PictureRequest request,
                              std::initializer_list<double> spacings) {
    request.spacing = 0;
    const std::vector<bool> inside = interior(draw(model, request).image);
    ASSERT_GT(std::ranges::count(inside, true), 10000);
    uint32_t max_levels = 0;
    for (const double spacing : spacings) {
      for (const picture::Normalization normalization :
           {picture::Normalization::kPixel, picture::Normalization::kSurfel}) {
        request.spacing = spacing;
        request.normalization = normalization;
        const picture::Frame frame = draw(model, request);
        EXPECT_TRUE(frame.converged);
        max_levels = std::max(max_levels, levels_drawn(frame));
        const int tolerance = normalization == picture::Normalization::kPixel ? 1 : 2;
        expect_color(frame.image, inside, tolerance, spacing);
      }
    }
    EXPECT_GE(max_levels, 2u) << "the spacings mix levels";
  }

  static void expect_color(const picture::Image& image, const std::vector<bool>& inside, int tolerance,
                           double spacing) {
    int wrong = 0;
    int worst = 0;
    for (size_t i = 0; i < inside.size(); ++i) {
      if (!inside[i]) continue;
      const int x = static_cast<int>(i) % image.width;
      const int y = static_cast<int>(i) / image.width;
      const glm::ivec3 off = glm::abs(glm::ivec3(pixel(image, x, y)) - glm::ivec3(kColor));
      const int largest = std::max({off.x, off.y, off.z});
      wrong += largest > tolerance ? 1 : 0;
      worst = std::max(worst, largest);
    }
    EXPECT_EQ(wrong, 0) << "at spacing " << spacing << ", off by up to " << worst;
  }
};

TEST_F(LevelsGLTest, APlaneSeenAlongItHasNoSeams) {
  const auto& model = model_of(testing::square(400, 4, {0, 0, 0}, {0, 0, 1}, kColor));
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0, -3.2, 0.8}, {0, -0.6, 0}, {0, 0, 1}, 40};
  request.width = 480;
  request.height = 320;
  expect_no_seams(model, request, {2, 4, 6, 8, 12, 16});
}

TEST_F(LevelsGLTest, ASphereHasNoSeams) {
  const auto& model = model_of(testing::fibonacci_sphere(300000, 1, {0, 0, 0}, kColor));
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0.3, 1.9, 0.4}, {0, 0, 0}, {0, 0, 1}, 50};
  request.width = 400;
  request.height = 400;
  expect_no_seams(model, request, {1, 1.5, 2, 3, 4, 6});
}

/// Draws with a separate renderer on a separate thread, because a thread has only one GL context.
Result<picture::Frame> draw_within(size_t gpu_bytes, const testing::ModelPointer& model,
                                   const picture::PictureRequest& request) {
  return std::async(std::launch::async,
                    [&]() -> Result<picture::Frame> {
                      Result<std::unique_ptr<Renderer>> renderer = Renderer::create({.gpu_bytes = gpu_bytes});
                      if (!renderer) return fail(renderer);
                      const std::atomic<bool> never{false};
                      return (*renderer)->draw(model, request, never);
                    })
      .get();
}

TEST_F(LevelsGLTest, ABudgetTooSmallForTheModelDrawsACoarserCutAndSaysSo) {
  constexpr size_t kBudget = size_t{40} * 16384;
  const auto& model = model_of(testing::square(300, 4, {0, 0, 0}, {0, 0, 1}, kColor));
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 60};
  request.width = request.height = 200;
  const Result<picture::Frame> frame = draw_within(kBudget, model, request);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_FALSE(frame->converged);
  EXPECT_GT(frame->stats.levels.back().level, 0);
  EXPECT_LE(frame->stats.bytes_resident, kBudget);
  EXPECT_EQ(pixel(frame->image, 100, 100).a, 255);
}

/// A plane with a texture of waves between 6 and 60 surfels long.
surfel::SurfelCloud wavy_square(int side) {
  surfel::SurfelCloud cloud = testing::square(side, 4, {0, 0, 0}, {0, 0, 1}, kColor);
  for (size_t i = 0; i < cloud.size(); ++i) {
    const glm::dvec3 p = cloud.positions[i] * (side / 4.0);
    const double wave = std::sin(p.x / 1.0) + std::sin(p.y / 1.7 + 1) + std::sin((p.x + p.y) / 4) + std::sin(p.x / 9.5);
    cloud.colors->values[i] = glm::u16vec3(128 + 25 * wave, 120 + 20 * wave, 100 - 15 * wave);
  }
  return cloud;
}

double rms(const picture::Image& a, const picture::Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    sum += std::pow(std::to_integer<int>(a.pixels[i]) - std::to_integer<int>(b.pixels[i]), 2);
  }
  return std::sqrt(sum / static_cast<double>(a.pixels.size()));
}

TEST_F(LevelsGLTest, ASwitchOfLevelsIsNoMoreToSeeThanAStepOfTheCamera) {
  const auto& model = model_of(wavy_square(360));
  const auto at = [&](double distance) {
    picture::PictureRequest request;
    request.camera = geometry::Camera{{0, 0, distance}, {0, 0, 0}, {0, 1, 0}, 30};
    request.width = request.height = 256;
    request.spacing = 1;
    return draw(model, request);
  };
  // Bisection of the distance at which the last block of the finest level disappears.
  double near = 2;
  double far = 40;
  ASSERT_EQ(at(near).stats.levels.front().level, 0);
  ASSERT_GT(at(far).stats.levels.front().level, 0);
  while (far - near > 1e-4) {
    const double middle = 0.5 * (near + far);
    (at(middle).stats.levels.front().level == 0 ? near : far) = middle;
  }
  // The step of one frame of a slow movement: a seventh of the distance per second, at 30 frames per second.
  const double step = 0.005 * near;
  const double across = rms(at(near - step / 2).image, at(far + step / 2).image);
  const double before = rms(at(near - 1.5 * step).image, at(near - step / 2).image);
  const double after = rms(at(far + step / 2).image, at(far + 1.5 * step).image);
  EXPECT_LE(across, std::max(before, after));
}

TEST_F(LevelsGLTest, PicturesAtOnceEndAsTheWholePictureDoes) {
  const auto& model = model_of(testing::fibonacci_sphere(200000, 1, {0, 0, 0}, kColor));
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 50};
  request.width = request.height = 200;
  request.spacing = 2;
  const picture::Frame whole = draw(model, request);
  renderer_->release_model(*model);
  request.loading = picture::Loading::kNow;
  picture::Frame frame = draw(model, request);
  EXPECT_FALSE(frame.converged) << "nothing is loaded yet";
  for (int i = 0; i < 200 && !frame.converged; ++i) frame = draw(model, request);
  EXPECT_EQ(frame.image.pixels, whole.image.pixels);
}

}  // namespace
}  // namespace surfcast::render
