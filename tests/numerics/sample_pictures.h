#pragma once

#include <string>
#include <vector>

#include "picture/picture.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::testing {

/// A small picture of a small scene.
struct SamplePicture {
  std::string name;
  surfel::SurfelCloud cloud;
  picture::PictureRequest request;
};

/// One for every way of drawing: small and large splats, astride the eye's plane, crowded tiles, merged levels, several
/// layers, normalisations, light, silhouettes, eye-dome lighting.
std::vector<SamplePicture> sample_pictures();

/// A number that stands for the bytes of a picture (FNV-1a).
uint64_t hash_of(const picture::Image& image);

}  // namespace surfcast::testing
