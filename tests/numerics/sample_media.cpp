#include <array>
#include <cmath>
#include <fstream>

#include "builder/build_model.h"
#include "gaussian/gaussian_scenes.h"
#include "numerics/sample_pictures.h"

namespace surfcast::testing {
namespace {

namespace fs = std::filesystem;

bool build(const fs::path& input, const fs::path& model) {
  return builder::build_model(std::array{input}, model, {}, [](const builder::BuildStep&) {}).has_value();
}

/// 70 x 45 x 40 samples of waves within [-1, 1]^3.
bool build_waves(const fs::path& model) {
  const glm::ivec3 size(70, 45, 40);
  const fs::path grid = fs::path(model).replace_extension(".nrrd");
  std::ofstream file(grid, std::ios::binary);
  file << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 70 45 40\nspacings: 0.03 0.045 0.05\n"
          "axis mins: -1 -1 -1\nencoding: raw\n\n";
  for (int k = 0; k < size.z; ++k) {
    for (int j = 0; j < size.y; ++j) {
      for (int i = 0; i < size.x; ++i) {
        file.put(
            static_cast<char>(std::lround(120 + 110 * std::sin(0.2 * i) * std::cos(0.25 * j) * std::sin(0.3 * k))));
      }
    }
  }
  file.close();
  return build(grid, model);
}

bool build_needles(const fs::path& model) {
  return build(write_ply(fs::path(model).replace_extension(".ply"), reference::make_gaussian_model("needles")), model);
}

picture::PictureRequest view() {
  picture::PictureRequest request;
  request.camera = geometry::Camera{{1.3, 1.1, 3}, {0, 0, 0}, {0, 1, 0}, 36};
  request.width = 96;
  request.height = 72;
  request.background = {30, 40, 60};
  request.volumes.transfer.points = {{110, {0.3, 0.5, 0.9}, 0}, {180, {0.9, 0.6, 0.2}, 0.2}, {230, {1, 1, 1}, 0.6}};
  return request;
}

}  // namespace

std::vector<SampleMedium> sample_media() {
  picture::PictureRequest shaded = view();
  shaded.volumes.shaded = true;
  shaded.clip.outside.push_back({{-0.2, -2, -2}, {0.3, 2, 2}});
  picture::PictureRequest coarse = view();
  coarse.spacing = 3;
  picture::PictureRequest exact = view();
  exact.splat_convention = picture::SplatConvention::kExact;
  return {{"waves", build_waves, view()},
          {"waves_shaded_clipped", build_waves, shaded},
          {"waves_coarse", build_waves, coarse},
          {"needles_trained", build_needles, view()},
          {"needles_exact", build_needles, exact}};
}

}  // namespace surfcast::testing
