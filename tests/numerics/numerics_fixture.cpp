#include "numerics/numerics_fixture.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <iostream>

#include "render/decoded_cloud.h"

namespace surfcast::testing {
namespace {

glm::dvec4 drawn_light(const picture::Image& image, const reference::Window& window, int x, int y) {
  const size_t at = static_cast<size_t>(window.y + y) * static_cast<size_t>(image.width) + window.x + x;
  glm::vec4 light;
  std::memcpy(&light, image.pixels.data() + sizeof light * at, sizeof light);
  return light;
}

}  // namespace

std::ostream& operator<<(std::ostream& out, const Difference& difference) {
  return out << "rms " << difference.rms << ", worst " << difference.worst << ", coverage " << difference.coverage
             << " of " << difference.peak;
}

Difference NumericsGLTest::difference(const std::string& what, const ModelPointer& model,
                                      picture::PictureRequest request) {
  request.format = picture::PixelFormat::kLinearFloat;
  return difference(what, draw(model, request).image, model, request, {0, 0, request.width, request.height});
}

Difference NumericsGLTest::difference(const std::string& what, const picture::Image& image, const ModelPointer& model,
                                      const picture::PictureRequest& request, const reference::Window& window) {
  const reference::ReferencePicture expected = reference::render(decoded_cloud(*model), request, {}, window);
  Difference found;
  double squares = 0;
  for (int y = 0; y < window.height; ++y) {
    for (int x = 0; x < window.width; ++x) {
      const size_t place = expected.picture.index(x, y);
      const glm::dvec4 actual = drawn_light(image, window, x, y);
      const glm::dvec3 d = glm::abs(glm::dvec3(actual) - expected.picture.pixels[place]);
      const double largest = std::max({d.x, d.y, d.z});
      // The comparisons are written so that NaN is kept.
      found.worst = largest <= found.worst ? found.worst : largest;
      const double coverage = std::abs(actual.a - expected.coverage[place]);
      found.coverage = coverage <= found.coverage ? found.coverage : coverage;
      found.peak = std::max(found.peak, expected.coverage[place]);
      squares += glm::dot(d, d) / 3;
    }
  }
  found.rms = std::sqrt(squares / (static_cast<double>(window.width) * window.height));
  std::cout << "[ measured ] " << what << ": " << found << '\n';
  return found;
}

void NumericsGLTest::expect_within(const Difference& difference, const Difference& bound) {
  EXPECT_LE(difference.rms, bound.rms);
  EXPECT_LE(difference.worst, bound.worst);
  EXPECT_LE(difference.coverage, bound.coverage);
}

void paint_motley(surfel::SurfelCloud& cloud) {
  for (size_t i = 0; i < cloud.size(); ++i) {
    const auto hash = static_cast<uint32_t>(i) * 2654435761U;
    cloud.colors->values[i] = glm::u16vec3(hash >> 24, (hash >> 16) & 255U, (hash >> 8) & 255U);
  }
}

}  // namespace surfcast::testing
