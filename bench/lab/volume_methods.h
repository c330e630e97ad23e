#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lab/results.h"
#include "lab/volume_subjects.h"
#include "reference/volume_ray_caster.h"
#include "render/renderer.h"

namespace surfcast::lab {

/// A way to draw a subject.
template <typename Subject>
struct LightMethod {
  MethodFacts facts;  ///< `plain`: a program of the tests, in double precision
  std::function<LightPicture(render::Renderer&, const Subject&)> draw;
};

/// Premultiplied light.
const std::vector<LightMethod<VolumeSubject>>& volume_methods();
/// Premultiplied sRGB codes.
const std::vector<LightMethod<GaussianSubject>>& gaussian_methods();

/// The picture of the device in linear light.
LightPicture draw_light(render::Renderer& renderer, const ModelPointer& model, picture::PictureRequest request);

/// The middle `side` x `side` pixels of a volume in double precision, with 16 samples a spacing: one ray a pixel, and
/// with Catmull-Rom interpolation under the pixel prefilter, as our rays.
LightPicture fine_middle(const VolumeSubject& subject, int side, reference::Reconstruction reconstruction);

}  // namespace surfcast::lab
