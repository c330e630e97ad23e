#include "reference/reference_renderer.h"

#include <algorithm>
#include <glm/common.hpp>

#include <gtest/gtest.h>

#include "reference/scenes.h"

namespace surfcast::reference {
namespace {

constexpr int kSmall = 128;  // pixels: keeps these tests quick

Scene small_scene(const std::string& name) {
  Scene scene = make_scene(name);
  scene.request.width = scene.request.height = kSmall;
  return scene;
}

/// The scene with the world scaled, then moved.
Scene transformed(Scene scene, double scale, const glm::dvec3& offset) {
  for (glm::dvec3& p : scene.cloud.positions) p = scale * p + offset;
  for (float& r : scene.cloud.radii) r = static_cast<float>(scale * r);
  geometry::Camera& camera = *scene.request.camera;
  camera.position = scale * camera.position + offset;
  camera.focal_point = scale * camera.focal_point + offset;
  return scene;
}

double largest_difference(const LinearPicture& a, const LinearPicture& b) {
  double largest = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const glm::dvec3 d = glm::abs(a.pixels[i] - b.pixels[i]);
    largest = std::max({largest, d.x, d.y, d.z});
  }
  return largest;
}

TEST(ReferenceRenderer, ShowsOneColorAsExactlyThatColorWhereCovered) {
  for (const char* name : {"color_plane", "color_sphere"}) {
    const Scene scene = small_scene(name);
    const ReferencePicture result = render(scene.cloud, scene.request);
    const SrgbPicture picture = encode(result.picture);
    size_t covered = 0;
    for (size_t i = 0; i < picture.pixels.size(); ++i) {
      if (result.coverage[i] < 1) continue;
      ++covered;
      EXPECT_EQ(picture.pixels[i], glm::u8vec3(200, 120, 40)) << name << " pixel " << i;
    }
    EXPECT_GT(covered, picture.pixels.size() / 3) << name;
  }
}

TEST(ReferenceRenderer, DoesNotSeeTheUnitOfLength) {
  const Scene scene = small_scene("checker_oblique");
  const LinearPicture expected = render(scene.cloud, scene.request).picture;
  for (const double scale : {1e-4, 1e5}) {
    const Scene scaled = transformed(scene, scale, glm::dvec3(0));
    // Radii are single precision: rounding them moves the kernel by some 1e-7 of its width.
    EXPECT_LT(largest_difference(render(scaled.cloud, scaled.request).picture, expected), 1e-5) << scale;
  }
}

TEST(ReferenceRenderer, DoesNotSeeTheOriginOfSurveyCoordinates) {
  const Scene scene = small_scene("checker_oblique");
  const LinearPicture expected = render(scene.cloud, scene.request).picture;
  const Scene moved = transformed(scene, 1, {448262.31, 5411932.67, 312.45});
  EXPECT_LT(largest_difference(render(moved.cloud, moved.request).picture, expected), 1e-5);
}

TEST(ReferenceRenderer, ShowsTheBackgroundWhereNothingIs) {
  Scene scene = small_scene("color_sphere");
  scene.request.background = {10, 20, 30};
  const ReferencePicture result = render(scene.cloud, scene.request);
  EXPECT_EQ(result.coverage.front(), 0);
  EXPECT_EQ(encode(result.picture).pixels.front(), glm::u8vec3(10, 20, 30));
}

TEST(ReferenceRenderer, HidesWhatLiesBehindASurface) {
  // A red sheet in front of a green one, farther than the visibility push of one spacing; both fill the picture.
  Scene scene = small_scene("color_plane");
  surfel::SurfelCloud& cloud = scene.cloud;
  const size_t count = cloud.size();
  cloud.colors->values.assign(count, {255, 0, 0});
  for (size_t i = 0; i < count; ++i) {
    cloud.positions.push_back(cloud.positions[i] - glm::dvec3(0, 0, 0.1));
    cloud.normals.push_back(cloud.normals[i]);
    cloud.radii.push_back(cloud.radii[i]);
    cloud.colors->values.emplace_back(0, 255, 0);
  }
  const ReferencePicture result = render(cloud, scene.request);
  const size_t centre = result.picture.index(kSmall / 2, kSmall / 2);
  EXPECT_EQ(encode(result.picture).pixels[centre], glm::u8vec3(255, 0, 0));
}

TEST(ReferenceRenderer, CullsBackFacesOnlyOfOrientedSurfaces) {
  Scene scene = small_scene("color_plane");
  for (glm::vec3& n : scene.cloud.normals) n = -n;
  const auto covered = [](const ReferencePicture& p) {
    return std::count_if(p.coverage.begin(), p.coverage.end(), [](double c) { return c > 0; });
  };
  EXPECT_EQ(covered(render(scene.cloud, scene.request)), 0);
  scene.cloud.oriented = false;
  EXPECT_GT(covered(render(scene.cloud, scene.request)), kSmall * kSmall / 2);
}

}  // namespace
}  // namespace surfcast::reference
