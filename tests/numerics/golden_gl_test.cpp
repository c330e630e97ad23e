// Golden pictures: inspected once and stored in tests/data/golden, so that every change of a picture is noticed.
//
// The file DEVICE.txt there names a device by GL's renderer and version strings. Another Mesa version or vector width
// of the processor counts as another device. On the named device the pictures must be equal to the bit, on other
// devices within a tolerance. The kernels for GPUs must draw the same pictures as those for processors.
// SURFCAST_EXPECTED_RENDERER is a part that the renderer string must have, so that a test of a second driver
// (CMakeLists.txt) cannot run on the first one.
//
// The test writes its pictures to the folder `golden` of the working directory. After an intended change, inspect them
// and copy them, on software GL of the Debian release on which the project is built:
//     ctest --test-dir build -R golden_gl_test; cp build/tests/numerics/golden/* tests/data/golden/

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "encode/encode_picture.h"
#include "model/write_model.h"
#include "numerics/sample_pictures.h"
#include "render/renderer.h"
#include "support/path_of.h"

namespace surfcast::testing {
namespace {

namespace fs = std::filesystem;

/// Tolerance for other devices, as PSNR. Rounding differs between devices, and a fragment at its cutoff may be accepted
/// or rejected. llvmpipe without AVX and FMA differs in one picture only, with 94 dB. If all fragments at the cutoff
/// were decided the other way, a picture would have 45 dB.
constexpr double kTolerance = 50;  // dB

/// Of a driver that is there to be compared with this device: levels of 255.
constexpr int kSecondDriverTolerance = 1;

std::string text_of(const fs::path& path) {
  std::ifstream stream(path);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The picture with its coverage in grey at its right, because the PNG files have no alpha channel.
picture::Image with_coverage(const picture::Image& image) {
  picture::Image both{2 * image.width, image.height, image.format, {}};
  both.pixels.resize(2 * image.pixels.size());
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::byte* from = image.pixels.data() + 4 * (static_cast<size_t>(y) * image.width + x);
      std::byte* left = both.pixels.data() + 4 * (static_cast<size_t>(2 * y) * image.width + x);
      std::byte* right = left + static_cast<size_t>(4) * image.width;
      for (int c = 0; c < 3; ++c) {
        left[c] = from[c];
        right[c] = from[3];
      }
    }
  }
  return both;
}

/// The RGB levels of a PNG file; empty if it cannot be read.
std::vector<uint8_t> levels_of(const fs::path& path) {
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) return {};
  const OIIO::ImageSpec& spec = input->spec();
  std::vector<uint8_t> levels(static_cast<size_t>(3) * spec.width * spec.height);
  if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, levels.data())) return {};
  return levels;
}

double psnr(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
  if (a.size() != b.size() || a.empty()) return 0;
  double squares = 0;
  for (size_t i = 0; i < a.size(); ++i) squares += std::pow(int{a[i]} - int{b[i]}, 2);
  return -10 * std::log10(squares / (255.0 * 255.0 * static_cast<double>(a.size())));
}

/// The largest difference of two levels; the largest there is when the sizes differ.
int largest_difference(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
  if (a.size() != b.size()) return 255;
  int largest = 0;
  for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(int{a[i]} - int{b[i]}));
  return largest;
}

/// The parameter: the kernels are those for GPUs.
class GoldenGLTest : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    Result<std::unique_ptr<render::Renderer>> created = render::Renderer::create({.gpu_kernels = GetParam()});
    ASSERT_TRUE(created) << created.error().message;
    renderer_ = std::move(*created);
    fs::create_directories(drawn_);
    models_ = fs::path(::testing::TempDir()) / ("surfcast_golden_" + std::to_string(getpid()));
    fs::create_directories(models_);
  }
  void TearDown() override {
    renderer_.reset();
    fs::remove_all(models_);
  }

  void draw(const SamplePicture& sample, const fs::path& file) {
    ASSERT_TRUE(model::write_model(sample.cloud, models_ / "model.surf", {}));
    Result<model::ModelFile> opened = model::ModelFile::open(models_ / "model.surf");
    ASSERT_TRUE(opened);
    const auto model = std::make_shared<const model::ModelFile>(std::move(*opened));
    const std::atomic<bool> cancelled{false};
    const Result<picture::Frame> frame = renderer_->draw(model, sample.request, cancelled);
    ASSERT_TRUE(frame) << frame.error().message;
    const Result<std::vector<std::byte>> png =
        encode::encode_picture(with_coverage(frame->image), picture::FileFormat::kPng, 100);
    ASSERT_TRUE(png);
    std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(png->data()), std::ssize(*png));
    renderer_->release_model(*model);
  }

  std::unique_ptr<render::Renderer> renderer_;
  fs::path models_;
  const fs::path golden_ = fs::path(path_of("tests/data")) / "golden";
  const fs::path drawn_ = fs::current_path() / (GetParam() ? "golden_by_gpu_kernels" : "golden");
};

INSTANTIATE_TEST_SUITE_P(Kernels, GoldenGLTest, ::testing::Bool(),
                         [](const auto& kernels) { return kernels.param ? "ForGpus" : "OfTheDevice"; });

TEST_P(GoldenGLTest, PicturesAreAsTheyWereLookedAt) {
  const char* expected = std::getenv("SURFCAST_EXPECTED_RENDERER");
  if (expected != nullptr) {
    ASSERT_NE(renderer_->device().renderer.find(expected), std::string::npos) << renderer_->device().renderer;
  }
  const std::string device = renderer_->device().renderer + "\n" + renderer_->device().version + "\n";
  std::ofstream(drawn_ / "DEVICE.txt") << device;
  const bool same_device = text_of(golden_ / "DEVICE.txt") == device;
  std::cout << "[ measured ] compared " << (same_device ? "to the bit" : "within a tolerance") << '\n';
  int largest = 0;
  for (const SamplePicture& sample : sample_pictures()) {
    const std::string file = sample.name + ".png";
    draw(sample, drawn_ / file);
    const std::vector<uint8_t> golden = levels_of(golden_ / file);
    const std::vector<uint8_t> drawn = levels_of(drawn_ / file);
    const double achieved = psnr(golden, drawn);
    EXPECT_GE(achieved, same_device ? std::numeric_limits<double>::infinity() : kTolerance)
        << file << ": see " << drawn_;
    if (!same_device) std::cout << "[ measured ] " << file << ": " << achieved << " dB\n";
    largest = std::max(largest, largest_difference(golden, drawn));
  }
  std::cout << "[ measured ] largest difference: " << largest << " of 255, drawn by " << renderer_->device().renderer
            << '\n';
  if (expected != nullptr) {
    EXPECT_LE(largest, kSecondDriverTolerance) << "see " << drawn_;
  }
}

}  // namespace
}  // namespace surfcast::testing
