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

/// Peak signal to noise ratio of two pictures of 8 bits, and the pixels that one of them covers and the other does not.
struct Comparison {
  double decibel = 0;
  size_t only_first = 0;
  size_t only_second = 0;
  size_t covered = 0;  ///< of the first
};

Comparison compare(const picture::Image& a, const picture::Image& b) {
  Comparison result;
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); i += 4) {
    for (size_t channel = 0; channel < 3; ++channel) {
      const double difference =
          std::to_integer<int>(a.pixels[i + channel]) - std::to_integer<int>(b.pixels[i + channel]);
      sum += difference * difference;
    }
    const bool first = std::to_integer<int>(a.pixels[i + 3]) > 127;
    const bool second = std::to_integer<int>(b.pixels[i + 3]) > 127;
    result.only_first += first && !second ? 1 : 0;
    result.only_second += second && !first ? 1 : 0;
    result.covered += first ? 1 : 0;
  }
  const double mean = sum / (0.75 * static_cast<double>(a.pixels.size()));
  result.decibel = 10 * std::log10(255.0 * 255.0 / mean);
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
  EXPECT_LE(finest.only_first, finest.covered / 1000);
  EXPECT_LE(finest.only_second, finest.covered / 1000);
}

TEST_F(InPlaceGLTest, AtASpacingItHasNoHolesThatTheModelLacks) {
  const ModelPointer model = in_place("hills.copc.laz");
  for (const double spacing : {1.0, 2.0}) {
    const Comparison same = compare_at(model, spacing);
    EXPECT_GT(same.decibel, 32) << spacing;
    EXPECT_LE(same.only_first, same.covered / 500) << spacing;
  }
}

TEST_F(InPlaceGLTest, AnEptFolderIsShownLikeACopcFile) {
  const Comparison same = compare_at(in_place("hills/ept.json"), 1);
  EXPECT_GT(same.decibel, 32);
  EXPECT_LE(same.only_first, same.covered / 500);
}

}  // namespace
}  // namespace surfcast::testing
