// Pictures of several models that are shown as one.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "gaussian/mixed_scene_fixture.h"
#include "model/write_model.h"
#include "support/clouds.h"
#include "surfel/curvature.h"

namespace surfcast::gaussian {
namespace {

using testing::draw;
using testing::ModelPointer;

ModelPointer join(const std::vector<std::pair<std::string, ModelPointer>>& models) {
  std::vector<model::Member> members;
  for (const auto& [name, model] : models) members.push_back({name, model});
  Result<model::ModelFile> joined = model::ModelFile::join(std::move(members));
  EXPECT_TRUE(joined) << (joined ? "" : joined.error().message);
  return std::make_shared<const model::ModelFile>(std::move(*joined));
}

constexpr int kWidth = 320;
constexpr int kHeight = 240;

picture::PictureRequest hills_view() {
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0.5, -3, 3}, {0, 0, 0}, {0, 0, 1}, 35};
  request.width = kWidth;
  request.height = kHeight;
  return request;
}

glm::dvec3 code_at(const picture::Image& image, int x, int y) {
  glm::u8vec4 p;
  std::memcpy(&p, image.pixels.data() + 4 * (static_cast<size_t>(y) * kWidth + static_cast<size_t>(x)), 4);
  return glm::dvec3(p);
}

/// Every point, from the axis z.
picture::PictureRequest axis_view() {
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0, 0, 12}, {0, 0, 0}, {0, 1, 0}, 35};
  request.width = kWidth;
  request.height = kHeight;
  request.spacing = 0;
  return request;
}

/// Domes whose tops are at z = 0, with normals away from the eye of axis_view().
surfel::SurfelCloud domes_from_behind() {
  surfel::SurfelCloud cloud = testing::square(30, 2, {1.5, 0, 0}, {0, 0, -1}, {20, 90, 200});
  surfel::add_curvature(std::vector<surfel::CurvatureCode>(cloud.size(), {200, 0, 100, 0}), cloud);
  return cloud;
}

class JoinedModelsGL : public testing::MixedSceneFixture {
 protected:
  ModelPointer written(const std::string& name, const surfel::SurfelCloud& cloud) {
    const std::filesystem::path path = folder_ / (name + ".surf").c_str();
    const Result<model::WriteReport> report = model::write_model(cloud, path, {});
    EXPECT_TRUE(report) << (report ? "" : report.error().message);
    return std::make_shared<const model::ModelFile>(std::move(*model::ModelFile::open(path)));
  }
  /// Two models together cost what each costs alone, and each looks as it does alone.
  static void expect_each_as_alone(const ModelPointer& a, const ModelPointer& b) {
    const ModelPointer joined = join({{"a", a}, {"b", b}});
    const picture::Frame both = draw(*renderer_, joined, axis_view());
    const picture::Frame first = draw(*renderer_, a, axis_view());
    const picture::Frame second = draw(*renderer_, b, axis_view());
    EXPECT_EQ(both.stats.surfels_drawn, first.stats.surfels_drawn + second.stats.surfels_drawn);
    EXPECT_EQ(both.stats.blocks_selected, first.stats.blocks_selected + second.stats.blocks_selected);
    picture::PictureRequest request = axis_view();
    request.hidden_models = {"b"};
    EXPECT_EQ(draw(*renderer_, joined, request).image.pixels, first.image.pixels);
    request.hidden_models = {"a"};
    EXPECT_EQ(draw(*renderer_, joined, request).image.pixels, second.image.pixels);
  }
  /// Points on hills of several colours, at random places, with x from `low` to `high`.
  std::filesystem::path hills(const std::string& name, double low, double high) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-1, 1);
    std::string text = "x,y,z,red,green,blue\n";
    for (int i = 0; i < 120'000; ++i) {
      const double x = place(random);
      const double y = place(random);
      const double z = 0.2 * std::sin(4 * x) * std::cos(3 * y);
      const auto code = [](double wave) { return std::to_string(std::lround(128 + 100 * std::sin(wave))); };
      if (!(x >= low && x < high)) continue;
      text += number(x) + "," + number(y) + "," + number(z) + "," + code(7 * x) + "," + code(5 * y) + "," +
              code(9 * (x + y)) + "\n";
    }
    return testing::write(folder_ / name.c_str(), text);
  }
};

TEST_F(JoinedModelsGL, AJoinOfAllKindsHasTheBytesOfTheModelThatMixesThem) {
  const std::vector<std::filesystem::path> inputs{plane(0.3), cube(), glyph(0), splat()};
  const ModelPointer mixed = build(inputs);
  std::vector<std::pair<std::string, ModelPointer>> members;
  for (const std::filesystem::path& input : inputs) members.emplace_back(input.filename(), build({input}));
  const ModelPointer joined = join(members);
  ASSERT_EQ(joined->blocks().size(), mixed->blocks().size());
  for (const double opacity : {1.0, 0.5}) {
    for (const auto convention : {picture::SplatConvention::kTrained, picture::SplatConvention::kExact}) {
      picture::PictureRequest request = request_of(convention);
      request.class_opacities = {{5, opacity}};
      EXPECT_EQ(draw(*renderer_, joined, request).image.pixels, draw(*renderer_, mixed, request).image.pixels)
          << opacity << ' ' << static_cast<int>(convention);
    }
  }
}

TEST_F(JoinedModelsGL, TheHalvesOfAScanLookLikeTheScan) {
  const ModelPointer whole = build({hills("whole.csv", -1, 1.1)});
  const ModelPointer joined =
      join({{"left", build({hills("left.csv", -1, 0)})}, {"right", build({hills("right.csv", 0, 1.1)})}});
  ASSERT_EQ(joined->info().surfels, whole->info().surfels);
  const picture::Image wanted = draw(*renderer_, whole, hills_view()).image;
  const picture::Image found = draw(*renderer_, joined, hills_view()).image;
  const auto frame = *geometry::make_camera_frame(*hills_view().camera, kWidth, kHeight);
  double error = 0;
  double all_error = 0;
  int pixels = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const glm::dvec3 difference = code_at(found, x, y) - code_at(wanted, x, y);
      const double squared = glm::dot(difference, difference) / 3;
      all_error += squared;
      // The seam is the plane x = 0.
      const glm::dvec2 low = frame.project(frame.to_camera({0, -1, 0}));
      const glm::dvec2 high = frame.project(frame.to_camera({0, 1, 0}));
      const double at = low.x + (high.x - low.x) * (y + 0.5 - low.y) / (high.y - low.y);
      if (std::abs(x + 0.5 - at) < 12) continue;
      error += squared;
      ++pixels;
    }
  }
  const auto psnr = [](double squares, int count) { return 10 * std::log10(255.0 * 255.0 * count / squares); };
  EXPECT_GT(psnr(error, pixels), 40) << "away from the seam";
  EXPECT_GT(psnr(all_error, kWidth * kHeight), 38) << "with the seam";
  RecordProperty("psnr_away_from_the_seam", std::to_string(psnr(error, pixels)));
  RecordProperty("psnr_with_the_seam", std::to_string(psnr(all_error, kWidth * kHeight)));
}

TEST_F(JoinedModelsGL, HiddenMembersAreNeitherDrawnNorSelected) {
  const ModelPointer left = build({hills("left.csv", -1, 0)});
  const ModelPointer right = build({hills("right.csv", 0, 1.1)});
  const ModelPointer joined = join({{"left", left}, {"right", right}});
  picture::PictureRequest request = hills_view();
  request.hidden_models = {"right"};
  const picture::Frame found = draw(*renderer_, joined, request);
  const picture::Frame alone = draw(*renderer_, left, hills_view());
  EXPECT_EQ(found.image.pixels, alone.image.pixels);
  EXPECT_EQ(found.stats.blocks_selected, alone.stats.blocks_selected);
  EXPECT_EQ(found.stats.surfels_drawn, alone.stats.surfels_drawn);
  request.hidden_models = {"left", "right"};
  const picture::Frame nothing = draw(*renderer_, joined, request);
  EXPECT_EQ(nothing.stats.blocks_drawn, 0U);
  EXPECT_TRUE(std::ranges::all_of(nothing.image.pixels, [](std::byte code) { return code == std::byte{0}; }));
  request.hidden_models = {"another"};
  EXPECT_EQ(draw(*renderer_, joined, request).image.pixels, draw(*renderer_, joined, hills_view()).image.pixels);
}

/// Strips of the hills that are single blocks.
TEST_F(JoinedModelsGL, FromAfarManyScansAreDrawnWithAsFewSurfelsAsOne) {
  constexpr int kStrips = 10;
  std::vector<std::pair<std::string, ModelPointer>> strips;
  for (int i = 0; i < kStrips; ++i) {
    const std::string name = "strip" + std::to_string(i);
    const double low = -1 + 2.0 * i / kStrips;
    strips.emplace_back(name, build({hills(name + ".csv", low, low + 2.0 / kStrips)}));
    ASSERT_EQ(strips.back().second->blocks().size(), 1U);
  }
  const ModelPointer whole = build({hills("whole.csv", -1, 1.1)});
  const ModelPointer joined = join(strips);
  picture::PictureRequest request = hills_view();
  request.camera->position *= 3;
  request.spacing = 8;
  const picture::Frame one = draw(*renderer_, whole, request);
  const picture::Frame many = draw(*renderer_, joined, request);
  EXPECT_LT(static_cast<double>(many.stats.surfels_drawn), 1.5 * static_cast<double>(one.stats.surfels_drawn));
  EXPECT_EQ(many.stats.blocks_drawn, 1U);

  request.spacing = 0;
  const picture::Image exact = draw(*renderer_, whole, request).image;
  const auto psnr = [&](const picture::Image& image) {
    double squares = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const glm::dvec3 difference = code_at(image, x, y) - code_at(exact, x, y);
        squares += glm::dot(difference, difference) / 3;
      }
    }
    return 10 * std::log10(255.0 * 255.0 * kWidth * kHeight / squares);
  };
  EXPECT_GT(psnr(many.image), psnr(one.image) - 2);
  RecordProperty("psnr_of_one_model", std::to_string(psnr(one.image)));
  RecordProperty("psnr_of_strips", std::to_string(psnr(many.image)));

  request.spacing = 8;
  request.hidden_models = {"strip4"};
  const picture::Image without = draw(*renderer_, joined, request).image;
  const auto frame = *geometry::make_camera_frame(*request.camera, kWidth, kHeight);
  const glm::dvec2 hidden = frame.project(frame.to_camera({-0.1, 0, 0}));
  const glm::dvec2 shown = frame.project(frame.to_camera({0.3, 0, 0}));
  const auto alpha = [&](const glm::dvec2& at) {
    const auto pixel = static_cast<size_t>(at.y) * kWidth + static_cast<size_t>(at.x);
    return static_cast<int>(without.pixels[4 * pixel + 3]);
  };
  EXPECT_EQ(alpha(hidden), 0);
  EXPECT_EQ(alpha(shown), 255);
}

TEST_F(JoinedModelsGL, AScanWithoutFrontsDoesNotShowTheBacksOfOthers) {
  surfel::SurfelCloud two_sided = testing::fibonacci_sphere(20'000, 1, {1.5, 0, 0}, {20, 90, 200});
  two_sided.oriented = false;
  const ModelPointer fronts = written("fronts", testing::fibonacci_sphere(200'000, 1, {-1.5, 0, 0}, {200, 90, 20}));
  const ModelPointer sides = written("sides", two_sided);
  const uint64_t all = draw(*renderer_, sides, axis_view()).stats.surfels_drawn;
  ASSERT_EQ(all, two_sided.size());
  ASSERT_LT(draw(*renderer_, fronts, axis_view()).stats.surfels_drawn, 100'000U);
  expect_each_as_alone(fronts, sides);
  expect_each_as_alone(sides, fronts);
}

TEST_F(JoinedModelsGL, SurfelsWithCurvatureHaveAsManySidesAsAlone) {
  surfel::SurfelCloud sphere = testing::fibonacci_sphere(20'000, 1, {-1.5, 0, 0}, {200, 90, 20});
  surfel::SurfelCloud domes = domes_from_behind();
  const ModelPointer backs = written("backs", domes);
  domes.oriented = false;
  const ModelPointer sides = written("sides", domes);
  ASSERT_EQ(draw(*renderer_, backs, axis_view()).stats.surfels_drawn, 0U);
  ASSERT_EQ(draw(*renderer_, sides, axis_view()).stats.surfels_drawn, domes.size());
  expect_each_as_alone(written("sphere", sphere), sides);
  sphere.oriented = false;
  expect_each_as_alone(backs, written("sphere", sphere));
}

TEST_F(JoinedModelsGL, TheDefaultCameraShowsAllMembers) {
  picture::PictureRequest request = hills_view();
  request.camera.reset();
  const ModelPointer whole = build({hills("whole.csv", -1, 1.1)});
  const ModelPointer joined =
      join({{"left", build({hills("left.csv", -1, 0)})}, {"right", build({hills("right.csv", 0, 1.1)})}});
  const geometry::Camera wanted = draw(*renderer_, whole, request).camera;
  const geometry::Camera found = draw(*renderer_, joined, request).camera;
  EXPECT_LT(glm::length(found.position - wanted.position), 0.05 * glm::length(wanted.position));
  EXPECT_LT(glm::length(found.focal_point - wanted.focal_point), 0.05);
}

}  // namespace
}  // namespace surfcast::gaussian
