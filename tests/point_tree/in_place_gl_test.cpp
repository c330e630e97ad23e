#include <cmath>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/disk_folder.h"
#include "base/file_source.h"
#include "builder/build_model.h"
#include "exporter/export_scan.h"
#include "point_tree/open_in_place.h"
#include "render/gl_fixture.h"

namespace surfcast::testing {
namespace {

namespace fs = std::filesystem;

bool covers(const picture::Image& image, int x, int y) {
  const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x);
  return std::to_integer<int>(image.pixels[4 * pixel + 3]) > 127;
}

/// Two pixels and more within what is covered: borders may differ by a pixel.
bool is_inside(const picture::Image& image, int x, int y) {
  constexpr int kBorder = 2;
  for (int dy = -kBorder; dy <= kBorder; ++dy) {
    for (int dx = -kBorder; dx <= kBorder; ++dx) {
      const bool within = x + dx >= 0 && x + dx < image.width && y + dy >= 0 && y + dy < image.height;
      if (!within || !covers(image, x + dx, y + dy)) return false;
    }
  }
  return true;
}

struct Comparison {
  double decibel = 0;  ///< peak signal to noise ratio
  size_t inside = 0;   ///< pixels inside of what the first picture covers
  size_t holes = 0;    ///< those of them that the second one does not cover
};

Comparison compare(const picture::Image& a, const picture::Image& b) {
  Comparison result;
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    if (i % 4 == 3) continue;
    const double difference = std::to_integer<int>(a.pixels[i]) - std::to_integer<int>(b.pixels[i]);
    sum += difference * difference;
  }
  const double mean = sum / (0.75 * static_cast<double>(a.pixels.size()));
  result.decibel = 10 * std::log10(255.0 * 255.0 / mean);
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      if (!is_inside(a, x, y)) continue;
      ++result.inside;
      result.holes += covers(b, x, y) ? 0 : 1;
    }
  }
  return result;
}

/// Hills with smooth colours, denser towards one corner.
void write_hills(const fs::path& path) {
  constexpr int kSide = 420;
  std::ofstream ply(path);
  ply << "ply\nformat ascii 1.0\nelement vertex " << kSide * kSide
      << "\nproperty double x\nproperty double y\nproperty double z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  for (int i = 0; i < kSide * kSide; ++i) {
    const double u = std::pow((i % kSide + 0.35 * (i % 7919 * 37 % 101) / 101.0) / kSide, 1.4);
    const double v = std::pow((i / kSide + 0.35 * (i % 10007 * 61 % 103) / 103.0) / kSide, 1.4);
    const double x = 100 * u;
    const double y = 100 * v;
    ply << x << ' ' << y << ' ' << 6 * std::sin(0.1 * x) * std::cos(0.07 * y) << ' '
        << static_cast<int>(127 + 120 * std::sin(0.2 * x)) << ' ' << static_cast<int>(127 + 120 * std::cos(0.15 * y))
        << ' ' << static_cast<int>(255 * u) << '\n';
  }
}

void write_points(const fs::path& path, const std::vector<glm::dvec3>& points) {
  std::ofstream ply(path);
  ply << "ply\nformat ascii 1.0\nelement vertex " << points.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
  for (const glm::dvec3& p : points) ply << p.x << ' ' << p.y << ' ' << p.z << '\n';
}

/// Houses on a plain of 48 x 48, one in each square of 12 x 12.
struct Village {
  static constexpr double kSquare = 12;
  static constexpr double kHalfHouse = 3;
  static constexpr double kHeight = 5;
  static constexpr double kSpacing = 0.1;

  static glm::dvec2 from_house(const glm::dvec3& p) {
    return {std::fmod(p.x, kSquare) - 0.5 * kSquare, std::fmod(p.y, kSquare) - 0.5 * kSquare};
  }
  static std::vector<glm::dvec3> scan() {
    std::vector<glm::dvec3> points;
    std::mt19937 random(2);
    std::normal_distribution<double> noise(0, 0.01);
    std::uniform_real_distribution<double> within(-0.4 * kSpacing, 0.4 * kSpacing);
    const auto add = [&](const glm::dvec3& p) {
      points.push_back(p + glm::dvec3(noise(random), noise(random), noise(random)));
    };
    for (double x = kSpacing; x < 4 * kSquare - kSpacing; x += kSpacing) {
      for (double y = kSpacing; y < 4 * kSquare - kSpacing; y += kSpacing) {
        const glm::dvec3 p(x + within(random), y + within(random), 0);
        const glm::dvec2 d = glm::abs(from_house(p));
        add({p.x, p.y, std::max(d.x, d.y) < kHalfHouse ? kHeight : 0});
      }
    }
    for (int house = 0; house < 16; ++house) {
      const glm::dvec3 centre((house % 4 + 0.5) * kSquare, (house / 4 + 0.5) * kSquare, 0);
      for (double along = -kHalfHouse; along < kHalfHouse; along += kSpacing) {
        for (double z = 0; z < kHeight; z += kSpacing) {
          const double a = along + within(random);
          const double up = z + within(random);
          add(centre + glm::dvec3(a, kHalfHouse, up));
          add(centre + glm::dvec3(a, -kHalfHouse, up));
          add(centre + glm::dvec3(kHalfHouse, a, up));
          add(centre + glm::dvec3(-kHalfHouse, a, up));
        }
      }
    }
    return points;
  }
  /// Of a point on a wall, a roof, or the plain.
  static glm::dvec3 outside_of(const glm::dvec3& p, const glm::dvec3& normal) {
    const glm::dvec2 d = from_house(p);
    if (std::abs(normal.z) > 0.7) return {0, 0, 1};
    return std::abs(d.x) > std::abs(d.y) ? glm::dvec3(d.x, 0, 0) : glm::dvec3(0, d.y, 0);
  }
};

class InPlaceGLTest : public RendererFixture {
 protected:
  void build(const fs::path& scan) {
    const auto built =
        builder::build_model(std::span(&scan, 1), folder_ / "built.surf", {}, [](const builder::BuildStep&) {});
    ASSERT_TRUE(built) << built.error().message;
    Result<model::ModelFile> opened = model::ModelFile::open(folder_ / "built.surf");
    ASSERT_TRUE(opened);
    built_ = std::make_shared<const model::ModelFile>(std::move(*opened));
  }

  /// Exports a scan and opens it in place.
  [[nodiscard]] ModelPointer in_place(const fs::path& scan, const fs::path& name) const {
    exporter::ExportOptions options;
    options.encoding.chunk_size = 5000;
    const auto exported = exporter::export_scan(scan, folder_ / name, options);
    EXPECT_TRUE(exported) << exported.error().message;
    Result<PositionedFile> file = PositionedFile::open(folder_ / name);
    EXPECT_TRUE(file);
    Result<model::ModelFile> model =
        point_tree::open_in_place(*point_tree::tree_format_of((folder_ / name).string()),
                                  std::make_unique<const FileSource>(std::move(*file), folder_ / name),
                                  std::make_unique<const DiskFolder>((folder_ / name).parent_path()), {}, nullptr);
    EXPECT_TRUE(model) << model.error().message;
    return std::make_shared<const model::ModelFile>(std::move(*model));
  }

  /// Compares pictures of both at that spacing.
  [[nodiscard]] Comparison compare_at(const ModelPointer& model, double spacing) const {
    picture::PictureRequest request;
    request.width = 320;
    request.height = 240;
    request.spacing = spacing;
    const picture::Frame expected = draw(built_, request);
    request.camera = expected.camera;
    return compare(expected.image, draw(model, request).image);
  }

  ModelPointer built_;
};

class HillsInPlaceGLTest : public InPlaceGLTest {
 protected:
  void SetUp() override {
    write_hills(scan_);
    build(scan_);
  }
  [[nodiscard]] ModelPointer in_place(const fs::path& name) const { return InPlaceGLTest::in_place(scan_, name); }

 private:
  const fs::path scan_ = folder_ / "hills.ply";
};

TEST_F(HillsInPlaceGLTest, TheFinestLevelOfACopcFileIsThatOfTheModel) {
  const Comparison finest = compare_at(in_place("hills.copc.laz"), 0);
  EXPECT_GT(finest.decibel, 40);
  EXPECT_GT(finest.inside, 10'000U);
  EXPECT_EQ(finest.holes, 0U);
}

TEST_F(HillsInPlaceGLTest, AtASpacingItHasNoHolesThatTheModelLacks) {
  const ModelPointer model = in_place("hills.copc.laz");
  for (const double spacing : {1.0, 2.0}) {
    const Comparison same = compare_at(model, spacing);
    EXPECT_GT(same.decibel, 32) << spacing;
    EXPECT_EQ(same.holes, 0U) << spacing;
  }
}

TEST_F(HillsInPlaceGLTest, AnEptFolderIsShownLikeACopcFile) {
  const Comparison same = compare_at(in_place("hills/ept.json"), 1);
  EXPECT_GT(same.decibel, 32);
  EXPECT_EQ(same.holes, 0U);
}

TEST_F(InPlaceGLTest, ALandscapeHasFronts) {
  const fs::path scan = folder_ / "village.ply";
  write_points(scan, Village::scan());
  const ModelPointer model = in_place(scan, "village.copc.laz");
  EXPECT_TRUE(model->info().partly_oriented);
  size_t discs = 0, walls = 0, oriented = 0, inwards = 0;
  for (uint32_t i = 0; i < model->blocks().size(); ++i) {
    const Result<model::DecodedBlock> block = model->decode(i);
    ASSERT_TRUE(block) << block.error().message;
    for (size_t k = 0; k < block->size(); ++k) {
      if (block->is_scatter(k)) continue;
      ++discs;
      if (!block->oriented) continue;
      ++oriented;
      const glm::dvec3 normal(block->normals[k]);
      walls += std::abs(normal.z) < 0.3 ? 1 : 0;
      inwards += glm::dot(normal, Village::outside_of(block->position(k), normal)) < 0 ? 1 : 0;
    }
  }
  EXPECT_GT(oriented, discs * 3 / 4);
  EXPECT_GT(walls, 20'000U);
  EXPECT_LT(inwards, oriented / 500);
  // From the street, as few surfels are drawn as of a model, and nothing is missing.
  build(scan);
  ASSERT_TRUE(built_->info().oriented);
  picture::PictureRequest request;
  request.width = 320;
  request.height = 240;
  request.spacing = 1;
  request.camera = geometry::Camera{{12, 1, 1.7}, {24, 36, 1.7}, {0, 0, 1}, 60};
  const picture::Frame expected = draw(built_, request);
  const picture::Frame frame = draw(model, request);
  const Comparison same = compare(expected.image, frame.image);
  EXPECT_GT(same.inside, 30'000U);
  EXPECT_LT(same.holes, same.inside / 1000) << "slits at corners";
  EXPECT_LT(static_cast<double>(frame.stats.surfels_drawn), 1.1 * static_cast<double>(expected.stats.surfels_drawn));
}

TEST_F(InPlaceGLTest, ARoomIsSeenFromBothSides) {
  const fs::path scan = folder_ / "room.ply";
  std::vector<glm::dvec3> points;
  std::mt19937 random(6);
  std::uniform_real_distribution<double> any(0, 1);
  for (int i = 0; i < 60'000; ++i) {  // floor, ceiling and four walls
    glm::dvec3 p(any(random), any(random), any(random));
    p[i % 3] = i / 3 % 2;
    points.push_back(p * glm::dvec3(8, 6, 3));
  }
  write_points(scan, points);
  const ModelPointer model = in_place(scan, "room.copc.laz");
  EXPECT_FALSE(model->info().partly_oriented);
  for (uint32_t i = 0; i < model->blocks().size(); ++i) EXPECT_FALSE(model->decode(i)->oriented) << i;
}

}  // namespace
}  // namespace surfcast::testing
