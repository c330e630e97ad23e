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

/// One picture for every code path of the renderer: small and large splats, splats across the eye's plane, overflowing
/// tiles, mixed levels, several layers, normalisations, lighting, silhouettes, eye-dome lighting.
std::vector<SamplePicture> sample_pictures();

/// Hash of the bytes of a picture (FNV-1a).
uint64_t hash_of(const picture::Image& image);

}  // namespace surfcast::testing
