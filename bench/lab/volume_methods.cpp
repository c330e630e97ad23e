#include "lab/volume_methods.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "bench_support.h"
#include "reference/gaussian_renderer.h"
#include "reference/slab_renderer.h"
#include "reference/volume_ray_caster.h"

namespace surfcast::lab {
namespace {

using reference::GaussianConvention;
using reference::Reconstruction;

constexpr double kFineSamples = 16;  ///< a spacing of the grid, on the rays of a fine picture

/// Our rays at a spacing of blocks.
auto ours(double spacing) {
  return [spacing](render::Renderer& renderer, const VolumeSubject& subject) {
    picture::PictureRequest request = subject.request;
    request.spacing = spacing;
    return draw_light(renderer, subject.model, request);
  };
}

/// 3 x 3 of our pixels for each, which are filtered already.
LightPicture supersampled(render::Renderer& renderer, const VolumeSubject& subject) {
  constexpr int kSamples = 3;
  const int side = kSamples * (subject.request.width + 2 * reference::kFilterReach);
  picture::PictureRequest request = subject.request;
  request.width = request.height = side;
  request.camera = camera_of(with_pixels(subject.frame, side, kSamples));
  const double left = std::sqrt(kSamples * kSamples - 1.0) / kSamples;  // of the variance of one pixel
  return reference::reduced(draw_light(renderer, subject.model, request), kSamples, left);
}

auto cast(Reconstruction reconstruction, bool filtered) {
  return [=](render::Renderer&, const VolumeSubject& subject) {
    LightPicture picture = ray_cast(subject.grid, subject.transfer, false, subject.frame, reconstruction);
    return filtered ? reference::filtered(picture) : picture;
  };
}

auto drawn(picture::SplatConvention convention) {
  return [convention](render::Renderer& renderer, const GaussianSubject& subject) {
    picture::PictureRequest request = subject.request;
    request.splat_convention = convention;
    const picture::Image image = bench::draw_or_exit(renderer, subject.model, request).image;
    LightPicture picture(image.width, image.height);
    for (size_t i = 0; i < picture.pixels.size(); ++i) {
      glm::u8vec4 p;
      std::memcpy(&p, image.pixels.data() + i * sizeof p, sizeof p);
      picture.pixels[i] = glm::dvec4(p) / 255.0;
    }
    return picture;
  };
}

auto as_trained(GaussianConvention convention) {
  return [convention](render::Renderer&, const GaussianSubject& subject) {
    return draw_as_trained(subject.splats, subject.frame, convention);
  };
}

LightPicture in_order_of_centres(render::Renderer& /*renderer*/, const GaussianSubject& subject) {
  reference::ExactRules rules;
  rules.order_by_pixel = false;
  return draw_exactly(subject.splats, subject.frame, rules);
}

}  // namespace

LightPicture draw_light(render::Renderer& renderer, const ModelPointer& model, picture::PictureRequest request) {
  request.format = picture::PixelFormat::kLinearFloat;
  const picture::Image image = bench::draw_or_exit(renderer, model, request).image;
  LightPicture light(image.width, image.height);
  for (size_t i = 0; i < light.pixels.size(); ++i) {
    glm::vec4 pixel;
    std::memcpy(&pixel, image.pixels.data() + i * sizeof pixel, sizeof pixel);
    light.pixels[i] = glm::dvec4(pixel);
  }
  return light;
}

const std::vector<LightMethod<VolumeSubject>>& volume_methods() {
  static const std::vector<LightMethod<VolumeSubject>> list{
      {{"10 px", "rays through coarser levels, `--spacing 10`", false}, ours(10)},
      {{"2 px", "`--spacing 2`", false}, ours(2)},
      {{"rays", "rays as they are by default, one a pixel", false}, ours(0)},
      {{"3 x 3 rays", "the same with 3 x 3 times the pixels, filtered to the same pixels", false}, supersampled},
      {{"trilinear", "ray casting by linear interpolation, two samples a spacing, one ray a pixel", true},
       cast(Reconstruction::kTrilinear, false)},
      {{"trilinear, filtered", "the same under the pixel prefilter", true}, cast(Reconstruction::kTrilinear, true)},
      {{"cubic, filtered", "the same by cubic interpolation (Catmull-Rom)", true},
       cast(Reconstruction::kCatmullRom, true)},
      {{"kernels", "Gaussian kernels summed into slabs", true}, [](render::Renderer&, const VolumeSubject& subject) {
         return draw_slabs(subject.grid, 0, subject.transfer, subject.frame).picture;
       }}};
  return list;
}

const std::vector<LightMethod<GaussianSubject>>& gaussian_methods() {
  static const std::vector<LightMethod<GaussianSubject>> list{
      {{"trained", "`--splat-convention trained`", false}, drawn(picture::SplatConvention::kTrained)},
      {{"exact", "`--splat-convention exact`", false}, drawn(picture::SplatConvention::kExact)},
      {{"trained, double", "the rules of the training program", true}, as_trained(GaussianConvention::kTrained)},
      {{"antialiased, double", "the same with compensated opacities", true},
       as_trained(GaussianConvention::kAntialiased)},
      {{"one order, double", "exact footprints in the order of the centres", true}, in_order_of_centres},
      {{"exact, double", "exact footprints in the order of each pixel", true},
       [](render::Renderer&, const GaussianSubject& subject) { return draw_exactly(subject.splats, subject.frame); }}};
  return list;
}

LightPicture fine_middle(const VolumeSubject& subject, int side, Reconstruction reconstruction) {
  const bool cubic = reconstruction == Reconstruction::kCatmullRom;
  const int border = cubic ? reference::kFilterReach : 0;
  const geometry::CameraFrame frame = with_pixels(subject.frame, side + 2 * border);
  const glm::dmat3& axes = subject.grid.axes;
  const glm::dmat3 to_index = glm::inverse(axes);
  const auto interpolate = cubic ? reference::catmull_rom : reference::trilinear;
  const reference::RayMedium medium{
      [&](const glm::dvec3& place) { return interpolate(subject.grid, to_index * (place - subject.grid.origin)); }, {}};
  const double step = std::min({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])}) / kFineSamples;
  const LightPicture rays = reference::sampled_picture(frame.width, frame.height, [&](const glm::dvec2& pixel) {
    const glm::dvec3 direction = reference::ray_direction(frame, pixel);
    const auto part = reference::visible_interval(subject.grid, {}, frame.eye, direction);
    return reference::cast_ray(medium, subject.transfer, frame.eye, direction, part, step);
  });
  return cubic ? inner_part(reference::filtered(rays), border) : rays;
}

}  // namespace surfcast::lab
