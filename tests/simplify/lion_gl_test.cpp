// A real scan: curvature where it lowers the residual of the samples, averages elsewhere, against the picture
// of all of its points.

#include <array>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "render/decoded_cloud.h"
#include "render/gl_fixture.h"
#include "simplify/point_tree.h"
#include "simplify/simplify.h"
#include "simplify/smooth_scenes.h"
#include "support/path_of.h"

namespace surfcast::testing {
namespace {

using simplify::Near;
using simplify::Sample;

/// Levels of grey and coverage.
struct Drawn {
  std::vector<double> levels;
  std::vector<bool> inside;
};

class LionGLTest : public RendererFixture {
 protected:
  surfel::SurfelCloud lion() {
    const std::array<std::filesystem::path, 1> inputs{std::filesystem::path(path_of("tests/data")) / "lion.drc"};
    const auto built = builder::build_model(inputs, folder_ / "lion.surf", {}, [](const builder::BuildStep&) {});
    EXPECT_TRUE(built) << (built ? "" : built.error().message);
    const Result<model::ModelFile> model = model::ModelFile::open(folder_ / "lion.surf");
    surfel::SurfelCloud cloud = decoded_cloud(*model);
    cloud.colors.reset();
    cloud.scatter.clear();
    cloud.sources = {{"", 0, cloud.size(), std::nullopt}};
    return cloud;
  }

  Drawn drawn(const surfel::SurfelCloud& cloud) {
    picture::PictureRequest request;
    request.camera = camera_;
    request.width = request.height = 512;
    request.silhouettes = true;
    const picture::Frame frame = draw(model_of(cloud), request);
    camera_ = frame.camera;
    Drawn picture;
    for (int y = 0; y < 512; ++y) {
      for (int x = 0; x < 512; ++x) {
        picture.levels.push_back(pixel(frame.image, x, y).r);
        picture.inside.push_back(pixel(frame.image, x, y).a == 255);
      }
    }
    return picture;
  }

  std::optional<geometry::Camera> camera_;  ///< of the first picture
};

std::vector<Sample> samples_of(const surfel::SurfelCloud& cloud) {
  std::vector<Sample> samples;
  for (size_t i = 0; i < cloud.size(); ++i) samples.push_back({cloud.positions[i], glm::dvec3(cloud.normals[i])});
  return samples;
}

std::vector<Sample> around(const std::vector<Sample>& samples, const simplify::PointTree& tree, const Sample& centre,
                           double reach, bool oriented) {
  std::vector<Near> near;
  tree.within(centre.position, reach, near);
  std::vector<Sample> found;
  for (const Near& n : near) {
    const double cosine = glm::dot(samples[n.point].normal, centre.normal);
    if ((oriented ? cosine : std::abs(cosine)) > 0.3) found.push_back(samples[n.point]);
  }
  return found;
}

Sample mean_of(const std::vector<Sample>& samples, const glm::dvec3& like) {
  Sample mean{glm::dvec3(0), glm::dvec3(0)};
  for (const Sample& s : samples) {
    mean.position += s.position / static_cast<double>(samples.size());
    mean.normal += glm::dot(s.normal, like) < 0 ? -s.normal : s.normal;
  }
  mean.normal = glm::normalize(mean.normal);
  return mean;
}

struct Simplified {
  surfel::SurfelCloud averaged;
  surfel::SurfelCloud checked;
};

/// A surfel for each of `count` evenly spaced samples: the average of those it stands for, or curvature where it gains.
Simplified simplified(const surfel::SurfelCloud& cloud, size_t count) {
  const std::vector<Sample> samples = samples_of(cloud);
  const std::vector<uint32_t> subset = even_subset(samples, count);
  const double spacing = spacing_of(samples, subset);
  const simplify::PointTree tree(cloud.positions);
  std::vector<Sample> averages;
  std::vector<Sample> points;
  std::vector<surfel::CurvatureCode> codes;
  for (const uint32_t i : subset) {
    const Sample& centre = samples[i];
    averages.push_back(mean_of(around(samples, tree, centre, 0.55 * spacing, cloud.oriented), centre.normal));
    points.push_back(averages.back());
    codes.push_back({});
    const std::vector<Sample> wide = around(samples, tree, centre, 1.05 * spacing, cloud.oriented);
    if (static_cast<double>(samples.size()) < simplify::kMinSamplesPerPoint * static_cast<double>(subset.size()) ||
        wide.size() < 2 * simplify::kMinSamples) {
      continue;
    }
    const auto fit = simplify::fit_surface(centre.position, wide, cloud.oriented);
    if (!fit || fit->curvature.largest() * 1.08 * spacing > 0.9) continue;
    const auto plane = simplify::plane_of(*fit, wide, cloud.oriented);
    if (!simplify::gains(simplify::residual_of(*fit, wide, cloud.oriented),
                         simplify::residual_of(plane, wide, cloud.oriented), 1.05 * spacing)) {
      continue;
    }
    const surfel::OsculatingSurface stored = surfel::storable(*fit);
    points.back() = {stored.centre, stored.normal};
    codes.back() = surfel::encode_curvature(stored.curvature, 1.08 * spacing);
  }
  Simplified result{surfels_of(averages, 1.08 * spacing), surfels_of(points, 1.08 * spacing)};
  result.averaged.oriented = result.checked.oriented = cloud.oriented;
  surfel::add_curvature(codes, result.checked);
  return result;
}

double psnr_inside(const Drawn& a, const Drawn& ideal) {
  double sum = 0;
  double count = 0;
  for (size_t i = 0; i < ideal.levels.size(); ++i) {
    if (!ideal.inside[i]) continue;
    sum += std::pow(a.levels[i] - ideal.levels[i], 2);
    count += 1;
  }
  return 10 * std::log10(255.0 * 255.0 * count / sum);
}

/// Pixels that the points cover and the surfels do not, beside borders, which averages round off.
size_t holes_in(const Drawn& a, const Drawn& ideal) {
  size_t holes = 0;
  const auto covered = [&](int x, int y) { return ideal.inside[static_cast<size_t>(y * 512 + x)]; };
  for (int y = 8; y < 504; ++y) {
    for (int x = 8; x < 504; ++x) {
      bool deep = true;
      for (int v = -8; v <= 8 && deep; v += 2) {
        for (int u = -8; u <= 8 && deep; u += 2) deep = covered(x + u, y + v);
      }
      holes += deep && !a.inside[static_cast<size_t>(y * 512 + x)] ? 1 : 0;
    }
  }
  return holes;
}

TEST_F(LionGLTest, OneSurfelFor22PointsGainsTwoDecibelsOverAveragesAndHasNoHoles) {
  const surfel::SurfelCloud cloud = lion();
  const Drawn ideal = drawn(cloud);
  const Simplified s = simplified(cloud, cloud.size() / 22);
  const double averaged = psnr_inside(drawn(s.averaged), ideal);
  const Drawn checked = drawn(s.checked);
  std::cout << s.checked.size() << " surfels: averaged " << averaged << ", checked " << psnr_inside(checked, ideal)
            << " dB, holes " << holes_in(checked, ideal) << "\n";
  EXPECT_GE(psnr_inside(checked, ideal), averaged + 2);
  EXPECT_EQ(holes_in(checked, ideal), 0U);
}

TEST_F(LionGLTest, FewerPointsThanCurvatureNeedsAreAverages) {
  const surfel::SurfelCloud cloud = lion();
  const Simplified s = simplified(cloud, cloud.size() / 8);
  const Drawn ideal = drawn(cloud);
  EXPECT_GE(psnr_inside(drawn(s.checked), ideal), psnr_inside(drawn(s.averaged), ideal) - 0.5);
}

TEST_F(LionGLTest, SimplifyingItToAFewDegreesIsRefused) {
  surfel::SurfelCloud cloud = lion();
  const simplify::SimplifyReport report = simplify::simplify({2, std::nullopt}, cloud);
  std::cout << report.points << " surfels for " << report.samples << " points: " << report.reason << "\n";
  EXPECT_FALSE(report.pays);
}

}  // namespace
}  // namespace surfcast::testing
