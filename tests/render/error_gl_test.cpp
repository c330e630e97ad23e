// Pictures whose spacing is chosen for an error or a time.

#include <cmath>

#include "render/gl_fixture.h"
#include "support/clouds.h"

namespace surfcast::render {
namespace {

class ErrorGLTest : public testing::RendererFixture {
 protected:
  /// A sphere with waves of colour, of which coarser levels show less.
  const testing::ModelPointer& waves() {
    surfel::SurfelCloud cloud = testing::fibonacci_sphere(200000, 1, {0, 0, 0}, {0, 0, 0});
    for (size_t i = 0; i < cloud.size(); ++i) {
      const double wave = std::sin(0.37 * static_cast<double>(i)) * std::sin(0.0021 * static_cast<double>(i));
      const auto level = static_cast<uint16_t>(128 + 60 * wave);
      cloud.colors->values[i] = glm::u16vec3(level, 255 - level, 128);
    }
    return model_of(cloud);
  }

  static picture::PictureRequest request() {
    picture::PictureRequest request;
    request.camera = geometry::Camera{{0, 0, 3.5}, {0, 0, 0}, {0, 1, 0}, 35};
    request.width = 600;
    request.height = 450;
    request.silhouettes = true;
    return request;
  }

  /// Over the pixels that either covers, dB.
  static double psnr(const picture::Image& a, const picture::Image& b) {
    double squares = 0;
    double samples = 0;
    for (int y = 0; y < a.height; ++y) {
      for (int x = 0; x < a.width; ++x) {
        const glm::ivec4 p(pixel(a, x, y));
        const glm::ivec4 q(pixel(b, x, y));
        if (p.a == 0 && q.a == 0) continue;
        const glm::ivec3 off = glm::ivec3(p) - glm::ivec3(q);
        squares += off.x * off.x + off.y * off.y + off.z * off.z;
        samples += 3;
      }
    }
    return 10 * std::log10(255.0 * 255 * samples / squares);
  }
};

TEST_F(ErrorGLTest, PicturesHaveTheErrorThatWasAskedForAndTheBytesOfTheirSpacing) {
  const testing::ModelPointer& model = waves();
  const picture::Frame finest = draw(model, request());
  double last = 1e9;
  for (const double asked : {28.0, 33.0, 38.0}) {
    picture::PictureRequest to_error = request();
    to_error.error = asked;
    const picture::Frame frame = draw(model, to_error);
    EXPECT_GE(psnr(frame.image, finest.image), asked - 1.5);
    EXPECT_LE(psnr(frame.image, finest.image), asked + 4);
    EXPECT_NEAR(frame.expected_error, psnr(frame.image, finest.image), 2);
    EXPECT_GT(frame.expected_ms, 0);
    EXPECT_LT(frame.spacing, last) << "a smaller error takes a finer picture";
    last = frame.spacing;
    picture::PictureRequest alone = request();
    alone.spacing = frame.spacing;
    EXPECT_EQ(draw(model, alone).image.pixels, frame.image.pixels);
  }
}

TEST_F(ErrorGLTest, LinearPicturesAreChosenByTheirDisplayedOnes) {
  const testing::ModelPointer& model = waves();
  picture::PictureRequest to_error = request();
  to_error.error = 33;
  to_error.format = picture::PixelFormat::kLinearFloat;
  const picture::Frame linear = draw(model, to_error);
  EXPECT_EQ(linear.image.format, picture::PixelFormat::kLinearFloat);
  picture::PictureRequest displayed = request();
  displayed.spacing = linear.spacing;
  EXPECT_NEAR(psnr(draw(model, displayed).image, draw(model, request()).image), linear.expected_error, 2);
}

TEST_F(ErrorGLTest, OtherPicturesInTheMiddleChangeNothing) {
  const testing::ModelPointer& model = waves();
  picture::PictureRequest to_error = request();
  to_error.error = 33;
  const picture::Frame expected = draw(model, to_error);
  renderer_->release_model(*model);  // a search begins where the last one of the model ended
  picture::PictureRequest other = request();
  other.width = other.height = 64;
  other.spacing = 4;
  const std::atomic<bool> never{false};
  size_t nested_frames = 0;
  const Preemption preemption(never, [&] {
    if (++nested_frames % 16 == 0) draw(model, other);
    return nested_frames % 16 == 0;
  });
  const Result<picture::Frame> frame = renderer_->draw(model, to_error, preemption);
  ASSERT_TRUE(frame);
  EXPECT_GT(nested_frames, 100u);
  EXPECT_EQ(frame->spacing, expected.spacing);
  EXPECT_EQ(frame->image.pixels, expected.image.pixels);
}

TEST_F(ErrorGLTest, ASearchEndsWhenItIsCancelled) {
  const testing::ModelPointer& model = waves();
  picture::PictureRequest to_error = request();
  to_error.error = 33;
  std::atomic<bool> cancelled{false};
  int asked = 0;
  const Preemption preemption(cancelled, [&] {
    cancelled = ++asked > 40;
    return false;
  });
  const Result<picture::Frame> frame = renderer_->draw(model, to_error, preemption);
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().kind, ErrorKind::kCancelled);
}

TEST_F(ErrorGLTest, WithTimeForItTheFinestLevelIsDrawn) {
  const testing::ModelPointer& model = waves();
  picture::PictureRequest to_time = request();
  to_time.time_ms = 1e7;
  const picture::Frame frame = draw(model, to_time);
  EXPECT_EQ(frame.spacing, 0);
  EXPECT_TRUE(std::isinf(frame.expected_error));
  EXPECT_EQ(frame.image.pixels, draw(model, request()).image.pixels);
}

TEST_F(ErrorGLTest, APictureOfASmallerRenderScaleShowsTheSame) {
  const testing::ModelPointer& model = waves();
  picture::PictureRequest half = request();
  const picture::Image whole = draw(model, half).image;
  half.render_scale = 0.5;
  const picture::Frame frame = draw(model, half);
  EXPECT_EQ(frame.render_scale, 0.5);
  EXPECT_EQ(frame.image.width, whole.width);
  EXPECT_EQ(frame.image.height, whole.height);
  EXPECT_GT(psnr(frame.image, whole), 20);
  EXPECT_EQ(frame.image.pixels, draw(model, half).image.pixels);
}

TEST_F(ErrorGLTest, ARenderScaleDoesNotRaiseTheLimitOfTheResolution) {
  picture::PictureRequest wide = request();
  wide.width = renderer_->max_resolution() + 1;
  wide.render_scale = 0.5;
  const std::atomic<bool> cancelled{false};
  const Result<picture::Frame> frame = renderer_->draw(waves(), wide, Preemption(cancelled));
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().kind, ErrorKind::kLimit);
}

TEST_F(ErrorGLTest, PicturesThatDoNotWaitAreNotSearched) {
  const testing::ModelPointer& model = waves();
  draw(model, request());
  picture::PictureRequest now = request();
  now.loading = picture::Loading::kNow;
  now.error = 20;
  const picture::Frame frame = draw(model, now);
  EXPECT_EQ(frame.spacing, 0);
  EXPECT_EQ(frame.expected_error, 0);
}

}  // namespace
}  // namespace surfcast::render
