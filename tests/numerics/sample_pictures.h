#pragma once

#include <filesystem>
#include <functional>
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

/// A small picture of a small volume or Gaussian model.
struct SampleMedium {
  std::string name;
  std::function<bool(const std::filesystem::path& model)> build;  ///< writes the model; false on failure
  picture::PictureRequest request;
};

/// Volumes of several bricks and levels, shaded and clipped, and Gaussian models as trained and exact.
std::vector<SampleMedium> sample_media();

/// Hash of the bytes of a picture (FNV-1a).
uint64_t hash_of(const picture::Image& image);

}  // namespace surfcast::testing
