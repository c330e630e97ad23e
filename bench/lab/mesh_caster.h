#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>

#include "geometry/camera.h"
#include "mesh/mesh.h"
#include "reference/light_picture.h"
#include "reference/linear_picture.h"

namespace surfcast::lab {

class CastScene;

/// A mesh that is drawn by rays, in double precision: the bilinear texture of each chart in linear light.
class MeshCaster {
 public:
  /// The mesh must outlive the caster. Images that cannot be read are left out.
  explicit MeshCaster(const mesh::Mesh& mesh);
  ~MeshCaster();
  MeshCaster(const MeshCaster&) = delete;
  MeshCaster& operator=(const MeshCaster&) = delete;

  /// The picture of 8 x 8 rays a pixel, filtered with the prefilter of pictures.
  [[nodiscard]] reference::LightPicture picture(const geometry::CameraFrame& frame) const;

 private:
  std::unique_ptr<const CastScene> scene_;
};

/// The error of a picture in dB, over all pixels, or over those of which every ray meets the mesh.
struct MeshError {
  double whole = 0;
  double inside = 0;
};
MeshError error_of(const reference::LightPicture& ideal, const reference::SrgbPicture& picture);

}  // namespace surfcast::lab
