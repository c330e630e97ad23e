// Blocks of which little is seen are drawn coarser, and the picture is hardly another one.

#include <cmath>
#include <future>
#include <thread>

#include <gmock/gmock.h>

#include "render/gl_fixture.h"
#include "support/clouds.h"

namespace surfcast::render {
namespace {

const std::atomic<bool> kNever{false};

/// Two walls with a gap between them, and twelve sheets behind them, each of another colour, that fill the view.
surfel::SurfelCloud street() {
  surfel::SurfelCloud cloud;
  for (const double x : {-2.0, 2.0}) {
    testing::append(cloud, testing::square(260, 3.6, {x, 0, 0}, {0, 0, 1}, {200, 120, 40}));
  }
  for (int i = 0; i < 12; ++i) {
    const auto shade = static_cast<uint8_t>(40 + 15 * i);
    testing::append(cloud, testing::square(260, 6 + 1.2 * i, {0.2 * i, 0, -2.0 - i}, {0, 0, 1},
                                           {shade, static_cast<uint8_t>(255 - shade), 90}));
  }
  return cloud;
}

picture::PictureRequest view_of_street() {
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0.3, 0.2, 3}, {0, 0, 0}, {0, 1, 0}, 50};
  request.width = 320;
  request.height = 240;
  request.spacing = 1;
  request.silhouettes = true;
  return request;
}

/// Calls with a renderer that has no blocks yet, on a thread of its own, because a thread has only one GL context.
template <typename Action>
auto with_renderer(const RendererConfig& config, Action action) {
  return std::async(std::launch::async,
                    [&] {
                      const Result<std::unique_ptr<Renderer>> renderer = Renderer::create(config);
                      EXPECT_TRUE(renderer) << renderer.error().message;
                      return action(**renderer);
                    })
      .get();
}

picture::Frame draw_with(const RendererConfig& config, const testing::ModelPointer& model,
                         const picture::PictureRequest& request) {
  return with_renderer(config, [&](Renderer& renderer) {
    Result<picture::Frame> frame = renderer.draw(model, request, kNever);
    EXPECT_TRUE(frame) << frame.error().message;
    return frame ? std::move(*frame) : picture::Frame();
  });
}

picture::Frame draw_anew(bool surveys, const testing::ModelPointer& model, const picture::PictureRequest& request) {
  return draw_with({.surveys = surveys}, model, request);
}

/// Peak signal to noise ratio, dB.
double psnr(const picture::Image& a, const picture::Image& b) {
  EXPECT_EQ(a.pixels.size(), b.pixels.size());
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    sum += std::pow(std::to_integer<int>(a.pixels[i]) - std::to_integer<int>(b.pixels[i]), 2);
  }
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.pixels.size()) / std::max(sum, 1e-9));
}

class SurveyGLTest : public testing::RendererFixture {};

TEST_F(SurveyGLTest, HiddenBlocksAreNotLoaded) {
  const auto& model = model_of(street());
  const picture::PictureRequest request = view_of_street();
  const picture::Frame all = draw_anew(false, model, request);
  const picture::Frame surveyed = draw_anew(true, model, request);
  EXPECT_TRUE(surveyed.converged);
  EXPECT_TRUE(surveyed.nothing_pending);
  EXPECT_LT(surveyed.stats.blocks_drawn, all.stats.blocks_drawn * 3 / 4);
  EXPECT_LT(surveyed.stats.bytes_resident, all.stats.bytes_resident * 4 / 5);
  EXPECT_GT(psnr(surveyed.image, all.image), 55);
}

TEST_F(SurveyGLTest, ThePictureDoesNotDependOnWhatIsResident) {
  const auto& model = model_of(street());
  const picture::PictureRequest request = view_of_street();
  picture::PictureRequest finest = request;
  finest.spacing = 0;
  const picture::Frame anew = draw_anew(true, model, request);
  draw(model, finest);
  const picture::Frame of_resident = draw(model, request);
  const picture::Frame again = draw(model, request);
  EXPECT_EQ(of_resident.stats.blocks_drawn, anew.stats.blocks_drawn);
  EXPECT_TRUE(of_resident.image.pixels == anew.image.pixels);
  EXPECT_TRUE(again.image.pixels == anew.image.pixels);
}

TEST_F(SurveyGLTest, AViewAtRestSharpensToThePictureOfASingleRequest) {
  const auto& model = model_of(street());
  picture::PictureRequest request = view_of_street();
  const picture::Frame single = draw_anew(true, model, request);
  request.loading = picture::Loading::kNow;
  int frames = 0;
  const picture::Frame last = with_renderer({}, [&](Renderer& renderer) {
    for (int i = 0; i < 20'000; ++i) {
      Result<picture::Frame> frame = renderer.draw(model, request, kNever);
      EXPECT_TRUE(frame) << frame.error().message;
      if (!frame || frame->nothing_pending) return frame ? std::move(*frame) : picture::Frame();
      EXPECT_FALSE(frame->converged);
      EXPECT_GT(frame->stats.blocks_missing, 0U);
      ++frames;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ADD_FAILURE() << "the view never ended";
    return picture::Frame();
  });
  EXPECT_GT(frames, 0);
  EXPECT_TRUE(last.converged);
  EXPECT_TRUE(last.image.pixels == single.image.pixels);
}

TEST_F(SurveyGLTest, APictureOfFewSurfelsIsSurveyedIfItIsAskedTo) {
  const auto& model = model_of(testing::square(100, 4, {0, 0, 0}, {0, 0, 1}, {200, 120, 40}));
  picture::PictureRequest request = view_of_street();
  const auto programs_for = [&](bool surveyed) {
    request.surveyed = surveyed;
    return with_renderer({}, [&](Renderer& renderer) {
      EXPECT_TRUE(renderer.draw(model, request, kNever));
      return renderer.programs().size();
    });
  };
  EXPECT_EQ(programs_for(true), programs_for(false) + 2) << "tiles without and with large splats";
}

TEST_F(SurveyGLTest, TheKernelsForGpusFindTheSame) {
  const auto& model = model_of(street());
  const picture::PictureRequest request = view_of_street();
  const picture::Frame software = draw_anew(true, model, request);
  const picture::Frame by_gpu_kernels = draw_with({.gpu_kernels = true}, model, request);
  EXPECT_EQ(by_gpu_kernels.stats.blocks_drawn, software.stats.blocks_drawn);
  EXPECT_GT(psnr(by_gpu_kernels.image, software.image), 55);
}

TEST_F(SurveyGLTest, TheFinestPictureIsNotSurveyed) {
  const auto& model = model_of(street());
  picture::PictureRequest request = view_of_street();
  request.spacing = 0;
  const picture::Frame all = draw_anew(false, model, request);
  const picture::Frame finest = draw_anew(true, model, request);
  EXPECT_EQ(finest.stats.blocks_drawn, all.stats.blocks_drawn);
  EXPECT_TRUE(finest.image.pixels == all.image.pixels);
}

TEST_F(SurveyGLTest, SurfacesThatAreSeenThroughHideNothing) {
  const auto& model = model_of(street());
  picture::PictureRequest request = view_of_street();
  request.opacity = 0.5;
  const picture::Frame all = draw_anew(false, model, request);
  const picture::Frame surveyed = draw_anew(true, model, request);
  EXPECT_EQ(surveyed.stats.blocks_drawn, all.stats.blocks_drawn);
  EXPECT_TRUE(surveyed.image.pixels == all.image.pixels);
}

/// What one picture hides is not hidden in another one.
TEST_F(SurveyGLTest, AnotherViewOfTheSameModelShowsWhatWasHidden) {
  const auto& model = model_of(street());
  const picture::PictureRequest front = view_of_street();
  picture::PictureRequest above = front;
  above.camera = geometry::Camera{{0, 9, 5}, {0, 0, -6}, {0, 1, 0}, 50};
  picture::PictureRequest clipped = front;
  clipped.clip.outside.push_back({{-9, -9, -0.5}, {9, 9, 0.5}});
  for (const picture::PictureRequest& request : {above, clipped}) {
    const picture::Frame all = draw_anew(false, model, request);
    draw(model, front);
    EXPECT_GT(psnr(draw(model, request).image, all.image), 55);
  }
}

TEST_F(SurveyGLTest, APictureAtRestThatIsNotSurveyedDoesNotDependOnSurveysOfOthers) {
  const auto& model = model_of(street());
  picture::PictureRequest request = view_of_street();
  request.normalization = picture::Normalization::kSurfel;
  const picture::Frame anew = draw_anew(true, model, request);
  draw(model, view_of_street());
  const picture::Frame after = draw(model, request);
  EXPECT_EQ(after.stats.blocks_drawn, anew.stats.blocks_drawn);
  EXPECT_TRUE(after.image.pixels == anew.image.pixels);
}

/// A frame of half the size, as a view in motion asks for it.
picture::PictureRequest in_motion(picture::PictureRequest request) {
  request.width /= 2;
  request.height /= 2;
  request.rest_spacing = request.spacing / 2;
  request.viewer = 1;
  request.loading = picture::Loading::kNow;
  request.silhouettes = false;
  return request;
}

TEST_F(SurveyGLTest, MotionThatBeginsAtASurveyedPictureDrawsAndLoadsNothingThatItHides) {
  const auto& model = model_of(street());
  const picture::PictureRequest rest = view_of_street();
  const auto draw_both = [&](bool surveys, const picture::PictureRequest& moving) {
    return with_renderer({.surveys = surveys}, [&](Renderer& renderer) {
      EXPECT_TRUE(renderer.draw(model, rest, kNever));
      Result<picture::Frame> frame = renderer.draw(model, moving, kNever);
      EXPECT_TRUE(frame) << frame.error().message;
      return frame ? std::move(*frame) : picture::Frame();
    });
  };
  const picture::Frame all = draw_both(false, in_motion(rest));
  const picture::Frame surveyed = draw_both(true, in_motion(rest));
  EXPECT_LT(surveyed.stats.blocks_selected, all.stats.blocks_selected * 3 / 4);
  EXPECT_EQ(surveyed.stats.blocks_missing, 0U);
  EXPECT_GT(psnr(surveyed.image, all.image), 45);

  picture::PictureRequest elsewhere = in_motion(rest);
  elsewhere.camera->position.x += 0.01;
  EXPECT_EQ(draw_both(true, elsewhere).stats.blocks_selected, draw_both(false, elsewhere).stats.blocks_selected);
  picture::PictureRequest wider = in_motion(rest);
  wider.width += 8;
  EXPECT_EQ(draw_both(true, wider).stats.blocks_selected, draw_both(false, wider).stats.blocks_selected);
  picture::PictureRequest clipped = in_motion(rest);
  clipped.clip.outside.push_back({{-9, -9, -0.5}, {9, 9, 0.5}});
  EXPECT_EQ(draw_both(true, clipped).stats.blocks_selected, draw_both(false, clipped).stats.blocks_selected);
}

}  // namespace
}  // namespace surfcast::render
