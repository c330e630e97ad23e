// A kind that is not built in, drawn in one picture with surfels.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <glm/vec4.hpp>
#include <limits>

#include <gtest/gtest.h>

#include "kinds/ball_scene.h"
#include "model/model_writer.h"
#include "model/test_folder.h"
#include "pick/pick_surfel.h"
#include "render/renderer.h"
#include "render/shader_library.h"
#include "support/mentions.h"

namespace surfcast::kinds {
namespace {

using testing::Ball;
using testing::BallScene;

constexpr int kSize = 256;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using ModelPointer = std::shared_ptr<const model::ModelFile>;

ModelPointer open(const std::filesystem::path& path) {
  Result<model::ModelFile> model = model::ModelFile::open(path);
  EXPECT_TRUE(model) << (model ? "" : model.error().message);
  return std::make_shared<const model::ModelFile>(std::move(*model));
}

std::unique_ptr<render::Renderer> renderer_of(KindTable kinds) {
  render::RendererConfig config;
  config.kinds = kinds;
  Result<std::unique_ptr<render::Renderer>> renderer = render::Renderer::create(config);
  EXPECT_TRUE(renderer);
  return std::move(*renderer);
}

Result<picture::Frame> draw(render::Renderer& renderer, const ModelPointer& model,
                            const picture::PictureRequest& request) {
  const std::atomic<bool> never{false};
  return renderer.draw(model, request, never);
}

glm::ivec4 pixel(const picture::Image& image, int x, int y) {
  glm::u8vec4 p;
  std::memcpy(&p, image.pixels.data() + 4 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + x), 4);
  return glm::ivec4(p);
}

bool near(const glm::ivec4& seen, const glm::u8vec3& color) {
  return std::abs(seen.r - color.r) <= 2 && std::abs(seen.g - color.g) <= 2 && std::abs(seen.b - color.b) <= 2;
}

/// A view from the front and a little above, so the square does not have constant depth.
picture::PictureRequest scene_view() {
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0.5, 2, 6}, {0, 0, 0}, {0, 1, 0}, 36};
  request.width = kSize;
  request.height = kSize;
  request.shading = picture::Shading::kUnlit;
  return request;
}

geometry::CameraFrame frame_of(const picture::PictureRequest& request) {
  return *geometry::make_camera_frame(*request.camera, request.width, request.height);
}

constexpr int kNothing = -1;
constexpr int kSquare = 0;  ///< balls are counted from 1 on

/// The item that a ray hits, computed in closed form.
struct Sight {
  int item = kNothing;
  double margin = kInfinity;  ///< distance in depth to the next item behind it
};

Sight sight_of(const BallScene& scene, const geometry::Clip& clip, const geometry::CameraFrame& frame,
               const glm::dvec2& at) {
  const glm::dvec3 ray = frame.ray(at);
  const glm::dvec3 direction = frame.right * ray.x + frame.up * ray.y + frame.forward;
  std::vector<std::pair<double, int>> hits;
  const double z = -frame.eye.z / direction.z;
  const glm::dvec3 p = frame.eye + z * direction;
  if (z > 0 && std::max(std::abs(p.x), std::abs(p.y)) < 0.5 * BallScene::kSide) hits.emplace_back(z, kSquare);
  for (size_t i = 0; i < scene.balls.size(); ++i) {
    const Ball& ball = scene.balls[i];
    if (!clip.shows(ball.centre)) continue;
    const glm::dvec3 o = frame.eye - ball.centre;
    const double a = glm::dot(direction, direction);
    const double b = glm::dot(direction, o);
    const double c = glm::dot(o, o) - double{ball.radius} * double{ball.radius};
    const double root = b * b - a * c;
    if (root >= 0) hits.emplace_back((-b - std::sqrt(root)) / a, static_cast<int>(i) + 1);
  }
  if (hits.empty()) return {};
  std::sort(hits.begin(), hits.end());
  return {hits[0].second, hits.size() > 1 ? hits[1].first - hits[0].first : kInfinity};
}

/// Calls `check(x, y, item)` for the pixels that show one item only. Returns their number for each item.
template <typename Check>
std::array<int, 6> for_each_sure_pixel(const BallScene& scene, const picture::PictureRequest& request,
                                       const Check& check) {
  constexpr int kReach = 3;          // pixels; larger than the prefilter's radius
  constexpr double kTogether = 0.1;  // surfaces that are closer count as one in the visibility pass
  const geometry::CameraFrame frame = frame_of(request);
  const auto sight = [&](int x, int y) { return sight_of(scene, request.clip, frame, {x + 0.5, y + 0.5}); };
  std::array<int, 6> counts{};
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const Sight here = sight(x, y);
      bool sure = here.margin > kTogether;
      for (int dy = -kReach; sure && dy <= kReach; dy += kReach) {
        for (int dx = -kReach; dx <= kReach; dx += kReach) sure &= sight(x + dx, y + dy).item == here.item;
      }
      if (!sure) continue;
      ++counts.at(static_cast<size_t>(here.item + 1));
      check(x, y, here.item);
    }
  }
  return counts;
}

glm::u8vec3 color_of(const BallScene& scene, int item) {
  if (item == kNothing) return {0, 0, 0};
  return item == kSquare ? BallScene::kSquareColor : scene.balls.at(static_cast<size_t>(item) - 1).color;
}

void expect_closed_form(const BallScene& scene, const picture::PictureRequest& request, const picture::Image& image,
                        int least) {
  int wrong = 0;
  const auto counts = for_each_sure_pixel(scene, request, [&](int x, int y, int item) {
    const glm::ivec4 seen = pixel(image, x, y);
    if (near(seen, color_of(scene, item)) && (seen.a == 255) == (item != kNothing)) return;
    if (++wrong == 1) {
      ADD_FAILURE() << "pixel " << x << ' ' << y << " is to show item " << item << ", is " << seen.r << ' ' << seen.g
                    << ' ' << seen.b << ' ' << seen.a;
    }
  });
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(counts[3], 0) << "the second ball is behind the square";
  for (const size_t seen : {0, 1, 2, 4, 5}) EXPECT_GE(counts.at(seen), least) << seen;
}

class KindsGLTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { renderer_ = renderer_of(testing::kinds_with_balls()); }
  static void TearDownTestSuite() { renderer_.reset(); }

  ModelPointer mixed() { return open(testing::write_scene(folder_ / "mixed.surf", scene_)); }
  static picture::Frame draw_scene(const ModelPointer& model, const picture::PictureRequest& request) {
    Result<picture::Frame> frame = draw(*renderer_, model, request);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
    return frame ? std::move(*frame) : picture::Frame{};
  }

  static inline std::unique_ptr<render::Renderer> renderer_;
  model::TestFolder folder_;
  BallScene scene_;
};

TEST_F(KindsGLTest, BallsAndSurfelsHideEachOtherAsTheirDepthsSay) {
  const picture::Frame frame = draw_scene(mixed(), scene_view());
  EXPECT_TRUE(frame.converged);
  EXPECT_EQ(frame.stats.blocks_missing, 0U);
  expect_closed_form(scene_, scene_view(), frame.image, 150);
}

TEST_F(KindsGLTest, BothNormalizationsAndSilhouettesShowTheSame) {
  const ModelPointer model = mixed();
  picture::PictureRequest request = scene_view();
  request.normalization = picture::Normalization::kSurfel;
  expect_closed_form(scene_, request, draw_scene(model, request).image, 150);
  request = scene_view();
  request.silhouettes = true;
  expect_closed_form(scene_, request, draw_scene(model, request).image, 150);
}

TEST_F(KindsGLTest, TheSameRequestGivesTheSameBytes) {
  const ModelPointer model = mixed();
  const picture::Frame first = draw_scene(model, scene_view());
  renderer_->release_model(*model);
  EXPECT_EQ(draw_scene(model, scene_view()).image.pixels, first.image.pixels);
}

TEST_F(KindsGLTest, BallsAreLitAndShadedByDepth) {
  const ModelPointer model = mixed();
  picture::PictureRequest request = scene_view();
  const glm::dvec2 at = frame_of(request).project(frame_of(request).to_camera(scene_.balls[0].centre));
  const auto middle = [&] {
    return pixel(draw_scene(model, request).image, static_cast<int>(at.x), static_cast<int>(at.y));
  };
  const int rim = static_cast<int>(at.x) + 23;
  request.shading = picture::Shading::kLit;
  const picture::Image lit = draw_scene(model, request).image;
  EXPECT_TRUE(near(middle(), scene_.balls[0].color)) << "a headlight shines on it";
  EXPECT_LT(pixel(lit, rim, static_cast<int>(at.y)).r,
            pixel(lit, static_cast<int>(at.x), static_cast<int>(at.y)).r - 40);
  request.eye_dome.strength = 1;
  EXPECT_GT(middle().r, 200);
  request.shading = picture::Shading::kUnlit;
  EXPECT_GT(middle().r, 200);
}

TEST_F(KindsGLTest, OptionsByPlaceApplyToBalls) {
  const ModelPointer model = mixed();
  picture::PictureRequest request = scene_view();
  request.clip.outside.push_back({{-2, -2, 0.5}, {2, 2, 2}});  // the first ball
  const picture::Image image = draw_scene(model, request).image;
  const auto counts = for_each_sure_pixel(scene_, request, [&](int x, int y, int item) {
    ASSERT_TRUE(near(pixel(image, x, y), color_of(scene_, item))) << x << ' ' << y;
  });
  EXPECT_EQ(counts[2], 0);
  request.clip = {};
  request.coloring.source = picture::SurfelColor::kElevation;
  const picture::Image map = draw_scene(model, request).image;
  const geometry::CameraFrame frame = frame_of(request);
  const glm::dvec2 high = frame.project(frame.to_camera(scene_.balls[0].centre));
  EXPECT_FALSE(near(pixel(map, static_cast<int>(high.x), static_cast<int>(high.y)), scene_.balls[0].color));
}

TEST_F(KindsGLTest, CoarseBlocksOfAKindAreSelectedLikeOthers) {
  const ModelPointer model = open(testing::write_balls(folder_ / "balls.surf", scene_));
  picture::PictureRequest request = scene_view();
  request.spacing = 1e6;
  const picture::Frame coarse = draw_scene(model, request);
  EXPECT_EQ(coarse.stats.blocks_drawn, 1U);
  EXPECT_TRUE(near(pixel(coarse.image, kSize / 2, kSize / 2), scene_.coarse.color));
  const picture::Frame fine = draw_scene(model, scene_view());
  EXPECT_EQ(fine.stats.blocks_drawn, 2U);
  for (size_t i = 0; i < scene_.balls.size(); ++i) {
    const geometry::CameraFrame frame = frame_of(request);
    const glm::dvec2 at = frame.project(frame.to_camera(scene_.balls.at(i).centre));
    EXPECT_TRUE(near(pixel(fine.image, static_cast<int>(at.x), static_cast<int>(at.y)), scene_.balls.at(i).color)) << i;
  }
}

TEST_F(KindsGLTest, TensOfThousandsOfBallsInOnePixelStayOpaque) {
  std::vector<Ball> crowd;
  for (int i = 0; i < 30000; ++i)
    crowd.push_back({glm::dvec3(i % 31, i % 37, i % 1009) / 1024.0, 0.25F, {10, 240, 30}});
  model::ModelSchema schema;
  schema.color_bits = 8;
  Result<model::ModelWriter> writer = model::ModelWriter::create(folder_ / "crowd.surf", schema);
  ASSERT_TRUE(writer);
  // 90000 records: more than the loop limit of llvmpipe (see draw_together.glsl).
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(writer->add(testing::encode_balls(crowd), ldc::OctreeKey(), {}));
  ASSERT_TRUE(writer->finish());
  const ModelPointer model = open(folder_ / "crowd.surf");
  picture::PictureRequest request = scene_view();
  request.camera = geometry::Camera{{0, 0, 60}, {0, 0, 0}, {0, 1, 0}, 36};
  const picture::Image image = draw_scene(model, request).image;
  EXPECT_TRUE(near(pixel(image, kSize / 2, kSize / 2), crowd.front().color));
  EXPECT_EQ(pixel(image, kSize / 2, kSize / 2).a, 255);
  EXPECT_EQ(draw_scene(model, request).image.pixels, image.pixels);
}

TEST_F(KindsGLTest, PicksTakeWhatThePictureShows) {
  const ModelPointer model = mixed();
  pick::SourceBlocks blocks(1 << 20, testing::kinds_with_balls());
  picture::PictureRequest request = scene_view();
  const geometry::CameraFrame frame = frame_of(request);
  const auto picked = [&](int x, int y) {
    const std::atomic<bool> never{false};
    return pick::pick_surfel(*model, {frame, {x + 0.5, y + 0.5}, request.clip, {}}, blocks, never);
  };
  for (const bool clipped : {false, true}) {
    if (clipped) request.clip.outside.push_back({{-2, -2, 0.5}, {2, 2, 2}});
    int looks = 0;
    for_each_sure_pixel(scene_, request, [&](int x, int y, int item) {
      if (++looks % 97 != 0) return;
      const Result<std::optional<PickedSurfel>> result = picked(x, y);
      ASSERT_TRUE(result) << result.error().message;
      ASSERT_EQ(result->has_value(), item != kNothing) << x << ' ' << y;
      if (item == kNothing) return;
      EXPECT_EQ(*(*result)->color, color_of(scene_, item)) << x << ' ' << y;
      if (item == kSquare) return;
      EXPECT_EQ((*result)->position, scene_.balls.at(static_cast<size_t>(item) - 1).centre);
    });
    EXPECT_GT(looks, 97 * 50);
  }
}

TEST_F(KindsGLTest, AKindCompilesNothingWhereItIsNotSeen) {
  const ModelPointer model = mixed();
  const std::unique_ptr<render::Renderer> renderer = renderer_of(testing::kinds_with_balls());
  picture::PictureRequest request = scene_view();
  request.silhouettes = true;
  request.camera = geometry::Camera{{-1.25, -1.25, 1}, {-1.25, -1.25, 0}, {0, 1, 0}, 20};  // a corner of the square
  ASSERT_TRUE(draw(*renderer, model, request));
  EXPECT_FALSE(testing::mentions(renderer->programs(), "ball"));
  EXPECT_TRUE(testing::mentions(renderer->programs(), "projection of surfel"));
  request = scene_view();
  ASSERT_TRUE(draw(*renderer, model, request));
  for (const char* name : {"projection of ball", "splat.comp with ball"}) {
    EXPECT_TRUE(testing::mentions(renderer->programs(), name)) << name;
  }
  const ModelPointer balls = open(testing::write_balls(folder_ / "balls.surf", scene_));
  const std::unique_ptr<render::Renderer> other = renderer_of(testing::kinds_with_balls());
  ASSERT_TRUE(draw(*other, balls, scene_view()));
  EXPECT_FALSE(testing::mentions(other->programs(), "projection of surfel"));
}

TEST(KindShadersTest, TheTextForSurfelsAloneHasNothingOfOtherKinds) {
  const render::EmbeddedShader kinds{"kinds/fragment_of.glsl", "// the kinds"};
  for (const char* file : {"splat.comp", "supersample.comp"}) {
    const Result<std::string> alone = render::shader_text(file);
    const Result<std::string> with_kinds = render::shader_text(file, std::span(&kinds, 1));
    ASSERT_TRUE(alone && with_kinds) << file;
    for (const char* word : {"Fragment f", "is_of_kind", "SURFCAST_KIND"}) {
      EXPECT_EQ(alone->find(word), std::string::npos) << file << ' ' << word;
      EXPECT_NE(with_kinds->find(word), std::string::npos) << file << ' ' << word;
    }
  }
}

TEST_F(KindsGLTest, AProgramThatDoesNotKnowAKindSaysWhichOne) {
  const ModelPointer model = mixed();
  const std::string expected = model->path().string() + ": has blocks of the unknown kind 'ball'";
  const std::unique_ptr<render::Renderer> renderer = renderer_of(built_in_kinds());
  const Result<picture::Frame> frame = draw(*renderer, model, scene_view());
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().kind, ErrorKind::kUnsupported);
  EXPECT_EQ(frame.error().message, expected);
  pick::SourceBlocks blocks(1 << 20);
  const std::atomic<bool> never{false};
  const PickQuery query{frame_of(scene_view()), {kSize / 2, kSize / 2}, {}, {}};
  EXPECT_EQ(pick::pick_surfel(*model, query, blocks, never).error().message, expected);
}

}  // namespace
}  // namespace surfcast::kinds
