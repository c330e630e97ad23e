// A scan, a mesh, glyphs, Gaussians and a volume that pierce each other, against one picture in double precision: every
// event on the ray of each pixel, in its order.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <iomanip>
#include <limits>
#include <random>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "gaussian/gaussian_files.h"
#include "gaussian/gaussian_scenes.h"
#include "model/test_folder.h"
#include "reference/ellipsoid_renderer.h"
#include "reference/ray_kernel.h"
#include "reference/volume_field.h"
#include "reference/volume_grid.h"

namespace surfcast::gaussian {
namespace {

constexpr int kPixels = 160;  // of a side
constexpr double kNowhere = std::numeric_limits<double>::infinity();
const glm::dvec3 kMedium(0.25, 0.5, 0.85);  // codes of the volume
constexpr double kDensest = 1.5;            // its extinction where the field is 1, for a unit of length
constexpr int kVolumeSamples = 64;          // along an axis

/// A rectangle of one colour.
struct Sheet {
  glm::dvec3 centre;
  glm::dvec3 u;  ///< unit, as v, and orthogonal to it
  glm::dvec3 v;
  double half = 1;  ///< of a side
  glm::ivec3 codes;
};

/// The scene, in the world.
struct Scene {
  Sheet scan{{0, 0, -0.3}, glm::normalize(glm::dvec3(1, 0, 0.25)), {}, 0.9, {200, 100, 40}};
  Sheet mesh{{0.3, -0.2, 0.45}, glm::normalize(glm::dvec3(0.6, 0, -1)), {0, 1, 0}, 0.4, {120, 200, 60}};
  std::vector<reference::EllipsoidGlyph> glyphs;
  std::vector<glm::ivec3> glyph_codes;
  reference::GaussianModel gaussians;
  reference::VolumeField field = reference::blobs_field();
  geometry::Camera camera{{1.7, 1.3, 4.4}, {0, 0, 0}, {0, 1, 0}, 30};
};

Scene make_scene() {
  Scene scene;
  scene.scan.v = glm::normalize(glm::cross(scene.scan.u, glm::dvec3(-0.2, -0.3, -1)));
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto side = [&] { return 2 * unit(random) - 1; };
  const auto turned = [&] { return glm::normalize(glm::dquat(side(), side(), side(), side())); };
  for (int i = 0; i < 6; ++i) {
    reference::EllipsoidGlyph glyph;
    glyph.centre = 0.7 * glm::dvec3(side(), side(), side());
    glyph.values = {0.3 + 0.15 * unit(random), 0.2 + 0.05 * unit(random), 0.1 + 0.05 * unit(random)};
    glyph.rotation = turned();
    scene.glyphs.push_back(glyph);
    scene.glyph_codes.emplace_back(40 + 200 * unit(random), 40 + 200 * unit(random), 40 + 200 * unit(random));
  }
  for (int i = 0; i < 12; ++i) {
    reference::GaussianSplat splat;
    splat.position = 0.8 * glm::dvec3(side(), side(), side());
    splat.log_scale = glm::log(glm::dvec3(0.08 + 0.15 * unit(random), 0.08 + 0.15 * unit(random), 0.05));
    splat.rotation = turned();
    splat.logit = std::log(0.7 / 0.3);
    const glm::dvec3 codes(0.2 + 0.7 * unit(random), 0.2 + 0.7 * unit(random), 0.2 + 0.7 * unit(random));
    splat.harmonics[0] = (codes - 0.5) / reference::harmonics({0, 0, 1})[0];
    scene.gaussians.splats.push_back(splat);
  }
  scene.gaussians = testing::in_single_precision(scene.gaussians);
  return scene;
}

// ---- the scene as files

std::filesystem::path write_scan(const std::filesystem::path& path, const Sheet& sheet) {
  constexpr int kCells = 150;
  const glm::dvec3 n = glm::cross(sheet.u, sheet.v);
  std::ostringstream text;
  text << std::setprecision(9) << "x,y,z,nx,ny,nz,red,green,blue\n";
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      const glm::dvec3 p =
          sheet.centre + sheet.half * ((2.0 * i / kCells - 1) * sheet.u + (2.0 * j / kCells - 1) * sheet.v);
      text << p.x << ',' << p.y << ',' << p.z << ',' << n.x << ',' << n.y << ',' << n.z << ',' << sheet.codes.x << ','
           << sheet.codes.y << ',' << sheet.codes.z << '\n';
    }
  }
  return testing::write(path, text.str());
}

std::filesystem::path write_mesh(const std::filesystem::path& path, const Sheet& sheet) {
  std::ostringstream text;
  text << std::setprecision(9)
       << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
          "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n"
          "property list uchar int vertex_indices\nend_header\n";
  for (const glm::dvec2& corner : {glm::dvec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
    const glm::dvec3 p = sheet.centre + sheet.half * (corner.x * sheet.u + corner.y * sheet.v);
    text << p.x << ' ' << p.y << ' ' << p.z << ' ' << sheet.codes.x << ' ' << sheet.codes.y << ' ' << sheet.codes.z
         << '\n';
  }
  text << "3 0 1 2\n3 0 2 3\n";
  return testing::write(path, text.str());
}

std::filesystem::path write_glyphs(const std::filesystem::path& path, const Scene& scene) {
  std::ostringstream text;
  text << std::setprecision(9) << "x,y,z,a,b,c,qw,qx,qy,qz,red,green,blue\n";
  for (size_t i = 0; i < scene.glyphs.size(); ++i) {
    const auto& [centre, values, q, color, sharpness] = scene.glyphs[i];
    const glm::ivec3& codes = scene.glyph_codes[i];
    text << centre.x << ',' << centre.y << ',' << centre.z << ',' << values.x << ',' << values.y << ',' << values.z
         << ',' << q.w << ',' << q.x << ',' << q.y << ',' << q.z << ',' << codes.x << ',' << codes.y << ',' << codes.z
         << '\n';
  }
  return testing::write(path, text.str());
}

std::filesystem::path write_volume(const std::filesystem::path& path, const reference::VolumeField& field) {
  const reference::VolumeGrid grid = reference::sampled(field, glm::ivec3(kVolumeSamples));
  const double step = 2.0 / (kVolumeSamples - 1);
  std::ostringstream text;
  text << std::setprecision(17) << "NRRD0004\ntype: double\ndimension: 3\nsizes: " << kVolumeSamples << ' '
       << kVolumeSamples << ' ' << kVolumeSamples << "\nspace dimension: 3\nspace directions: (" << step << ",0,0) (0,"
       << step << ",0) (0,0," << step << ")\nspace origin: (-1,-1,-1)\nendian: little\nencoding: raw\n\n";
  std::string bytes(grid.values.size() * sizeof(double), 0);
  std::memcpy(bytes.data(), grid.values.data(), bytes.size());
  return testing::write(path, text.str() + bytes);
}

// ---- the reference

/// What is on the ray of a pixel.
struct Seen {
  glm::dvec3 codes{0};
  int surface = 0;  ///< 0 none, 1 the scan, 2 the mesh, from 3 on glyphs
};

class Reference {
 public:
  explicit Reference(const Scene& scene)
      : scene_(scene), frame_(*geometry::make_camera_frame(scene.camera, kPixels, kPixels)) {
    for (const reference::EllipsoidGlyph& glyph : scene.glyphs) glyphs_.emplace_back(glyph, frame_);
    const glm::dmat3 to_camera = glm::transpose(glm::dmat3(frame_.right, frame_.up, frame_.forward));
    for (const reference::GaussianSplat& splat : scene.gaussians.splats) {
      glm::dmat3 axes = glm::mat3_cast(glm::normalize(splat.rotation));
      for (int i = 0; i < 3; ++i) axes[i] *= std::exp(splat.log_scale[i]);
      kernels_.emplace_back(frame_.rotate(splat.position - frame_.eye), to_camera * axes, frame_.eta, 1.0);
    }
  }

  [[nodiscard]] Seen at(int x, int y) const {
    const glm::dvec3 d = frame_.ray({x + 0.5, y + 0.5});
    const auto [surface, depth] = nearest_surface(d);
    glm::dvec3 codes(0);
    double through = 1;
    double place = 0;
    for (const Event& event : events(d, depth)) {
      pass(d, place, std::min(event.depth, depth), codes, through);
      place = std::max(place, std::min(event.depth, depth));
      codes += through * event.alpha * event.codes;
      through *= 1 - event.alpha;
    }
    pass(d, place, std::min(depth, kFarthest), codes, through);
    if (surface > 0) codes += through * codes_of(surface);
    return {codes, surface};
  }

 private:
  static constexpr double kFarthest = 12;  ///< depth behind all that is there

  struct Event {
    double depth = 0;
    double alpha = 0;
    glm::dvec3 codes{0};
  };

  [[nodiscard]] glm::dvec3 world(const glm::dvec3& d, double depth) const {
    return frame_.eye + depth * (d.x * frame_.right + d.y * frame_.up + d.z * frame_.forward);
  }

  [[nodiscard]] double hit(const Sheet& sheet, const glm::dvec3& d) const {
    const glm::dvec3 n = glm::cross(sheet.u, sheet.v);
    const glm::dvec3 ray = world(d, 1) - frame_.eye;
    const double depth = glm::dot(n, sheet.centre - frame_.eye) / glm::dot(n, ray);
    const glm::dvec3 place = frame_.eye + depth * ray - sheet.centre;
    const bool within = std::max(std::abs(glm::dot(place, sheet.u)), std::abs(glm::dot(place, sheet.v))) <= sheet.half;
    return depth > 0 && within ? depth : kNowhere;
  }

  [[nodiscard]] std::pair<int, double> nearest_surface(const glm::dvec3& d) const {
    std::pair<int, double> nearest{0, kNowhere};
    const auto offer = [&nearest](int surface, double depth) {
      if (depth < nearest.second) nearest = {surface, depth};
    };
    offer(1, hit(scene_.scan, d));
    offer(2, hit(scene_.mesh, d));
    for (size_t i = 0; i < glyphs_.size(); ++i) {
      if (const auto found = glyphs_[i].hit(d)) offer(static_cast<int>(i) + 3, found->depth);
    }
    return nearest;
  }

  [[nodiscard]] glm::dvec3 codes_of(int surface) const {
    const glm::ivec3 codes = surface == 1   ? scene_.scan.codes
                             : surface == 2 ? scene_.mesh.codes
                                            : scene_.glyph_codes.at(static_cast<size_t>(surface) - 3);
    return glm::dvec3(codes) / 255.0;
  }

  /// The Gaussians on a ray as far as a surface leaves them, by depth.
  [[nodiscard]] std::vector<Event> events(const glm::dvec3& d, double surface) const {
    std::vector<Event> found;
    for (size_t i = 0; i < kernels_.size(); ++i) {
      const reference::GaussianSplat& splat = scene_.gaussians.splats[i];
      const reference::KernelOnRay kernel = kernels_[i].on_ray(d);
      const double opacity = 1 / (1 + std::exp(-splat.logit));
      const double alpha = opacity * kernel.gain * reference::share_between(kernel, 0, surface);
      const glm::dvec3 codes = 0.5 + splat.harmonics[0] * reference::harmonics({0, 0, 1})[0];
      found.push_back({kernel.depth, alpha, codes});
    }
    std::ranges::sort(found, {}, &Event::depth);
    return found;
  }

  /// The medium between two depths.
  void pass(const glm::dvec3& d, double from, double to, glm::dvec3& codes, double& through) const {
    if (!(to > from)) return;
    constexpr double kStep = 0.004;
    const auto steps = static_cast<int>(std::ceil((to - from) / kStep));
    const double step = (to - from) / steps;
    for (int i = 0; i < steps; ++i) {
      const glm::dvec3 place = world(d, from + (i + 0.5) * step);
      if (std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)}) > 1) continue;
      const double extinction = kDensest * std::clamp(scene_.field.value(place), 0.0, 1.0);
      const double share = -std::expm1(-extinction * step * glm::length(d));
      codes += through * share * kMedium;
      through *= 1 - share;
    }
  }

  const Scene& scene_;
  const geometry::CameraFrame frame_;
  std::vector<reference::RayEllipsoid> glyphs_;
  std::vector<reference::RayKernel> kernels_;
};

/// True for pixels within two of another surface.
std::vector<bool> edges_of(const std::vector<Seen>& seen) {
  constexpr int kNear = 2;
  std::vector<bool> edges(seen.size());
  for (int y = 0; y < kPixels; ++y) {
    for (int x = 0; x < kPixels; ++x) {
      for (int b = std::max(0, y - kNear); b <= std::min(kPixels - 1, y + kNear); ++b) {
        for (int a = std::max(0, x - kNear); a <= std::min(kPixels - 1, x + kNear); ++a) {
          if (seen[b * kPixels + a].surface != seen[y * kPixels + x].surface) edges[y * kPixels + x] = true;
        }
      }
    }
  }
  return edges;
}

picture::Image drawn(const Scene& scene, const model::TestFolder& folder) {
  const std::vector<std::filesystem::path> inputs{
      write_scan(folder / "scan.csv", scene.scan), write_mesh(folder / "mesh.ply", scene.mesh),
      write_glyphs(folder / "glyphs.csv", scene), testing::write_ply(folder / "splats.ply", scene.gaussians),
      write_volume(folder / "blobs.nrrd", scene.field)};
  const auto report = builder::build_model(inputs, folder / "all.surf", {}, [](const builder::BuildStep&) {});
  EXPECT_TRUE(report) << (report ? "" : report.error().message);
  picture::PictureRequest request;
  request.camera = scene.camera;
  request.width = request.height = kPixels;
  request.splat_convention = picture::SplatConvention::kExact;
  request.shading = picture::Shading::kUnlit;
  request.background = {};
  // Extinction is linear in the value between the points: the opacity of a length of 1 at the densest place.
  request.volumes.transfer.points = {{0, kMedium, 0}, {1, kMedium, -std::expm1(-kDensest)}};
  request.volumes.transfer.spacing = 1;
  const std::unique_ptr<render::Renderer> renderer = std::move(*render::Renderer::create({}));
  const auto model = std::make_shared<const model::ModelFile>(std::move(*model::ModelFile::open(folder / "all.surf")));
  return testing::draw(*renderer, model, request).image;
}

TEST(MixedReferenceGL, AllKindsTogetherAreWithin45DecibelsOfDoublePrecision) {
  const Scene scene = make_scene();
  const model::TestFolder folder;
  const picture::Image image = drawn(scene, folder);
  const Reference reference(scene);
  std::vector<Seen> seen;
  for (int y = 0; y < kPixels; ++y) {
    for (int x = 0; x < kPixels; ++x) seen.push_back(reference.at(x, y));
  }
  const std::vector<bool> edges = edges_of(seen);
  double squares = 0;
  double whole = 0;
  double largest = 0;
  size_t count = 0;
  std::array<size_t, 9> surfaces{};
  for (size_t i = 0; i < seen.size(); ++i) {
    glm::u8vec4 p;
    std::memcpy(&p, image.pixels.data() + 4 * i, 4);
    const glm::dvec3 off = glm::dvec3(p) - 255.0 * seen[i].codes;
    whole += glm::dot(off, off) / 3;
    ++surfaces.at(static_cast<size_t>(seen[i].surface));
    if (edges[i]) continue;
    squares += glm::dot(off, off) / 3;
    largest = std::max({largest, std::abs(off.x), std::abs(off.y), std::abs(off.z)});
    ++count;
  }
  const auto decibels = [](double mean) { return 10 * std::log10(255.0 * 255.0 / mean); };
  const double found = decibels(squares / static_cast<double>(count));
  RecordProperty("dB", std::to_string(found));
  RecordProperty("whole_dB", std::to_string(decibels(whole / static_cast<double>(seen.size()))));
  RecordProperty("largest", std::to_string(largest));
  for (const size_t pixels : surfaces) EXPECT_GT(pixels, 20U) << "every surface is seen";
  EXPECT_GE(found, 45);
  EXPECT_LE(largest, 12) << "what is in front is in front in every pixel";
}

}  // namespace
}  // namespace surfcast::gaussian
