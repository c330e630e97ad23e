#include <cmath>
#include <fstream>
#include <memory>
#include <string>

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

class InPlaceGLTest : public RendererFixture {
 protected:
  void SetUp() override {
    write_hills(folder_ / "hills.ply");
    const fs::path scan = folder_ / "hills.ply";
    const auto built =
        builder::build_model(std::span(&scan, 1), folder_ / "hills.surf", {}, [](const builder::BuildStep&) {});
    ASSERT_TRUE(built) << built.error().message;
    Result<model::ModelFile> opened = model::ModelFile::open(folder_ / "hills.surf");
    ASSERT_TRUE(opened);
    built_ = std::make_shared<const model::ModelFile>(std::move(*opened));
  }

  /// Exports the scan and opens it in place.
  [[nodiscard]] ModelPointer in_place(const fs::path& name) const {
    exporter::ExportOptions options;
    options.encoding.chunk_size = 5000;
    const auto exported = exporter::export_scan(folder_ / "hills.ply", folder_ / name, options);
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

TEST_F(InPlaceGLTest, TheFinestLevelOfACopcFileIsThatOfTheModel) {
  const Comparison finest = compare_at(in_place("hills.copc.laz"), 0);
  EXPECT_GT(finest.decibel, 40);
  EXPECT_GT(finest.inside, 10'000U);
  EXPECT_EQ(finest.holes, 0U);
}

TEST_F(InPlaceGLTest, AtASpacingItHasNoHolesThatTheModelLacks) {
  const ModelPointer model = in_place("hills.copc.laz");
  for (const double spacing : {1.0, 2.0}) {
    const Comparison same = compare_at(model, spacing);
    EXPECT_GT(same.decibel, 32) << spacing;
    EXPECT_EQ(same.holes, 0U) << spacing;
  }
}

TEST_F(InPlaceGLTest, AnEptFolderIsShownLikeACopcFile) {
  const Comparison same = compare_at(in_place("hills/ept.json"), 1);
  EXPECT_GT(same.decibel, 32);
  EXPECT_EQ(same.holes, 0U);
}

}  // namespace
}  // namespace surfcast::testing
