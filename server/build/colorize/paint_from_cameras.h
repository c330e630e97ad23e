#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "base/result.h"
#include "colorize/paint_scan.h"
#include "colorize/photo_camera.h"
#include "mesh/texels.h"
#include "model/model_file.h"
#include "pick/front_surface.h"
#include "scan/row_source.h"

namespace surfcast::colorize {

/// A picture, and what of a model its camera sees.
struct Photo {
  PhotoCamera camera;
  mesh::Texture texture;
  geometry::CameraFrame frame;          ///< of `front`: the camera without distortion, with a margin
  std::vector<pick::FrontPixel> front;  ///< the model's front surface
};

/// Decodes the pictures and draws the front surface of `model` at each camera, as picks and channels see it. `limit`:
/// memory for all of them.
Result<std::vector<Photo>> take_photos(std::span<const PhotoCamera> cameras, const model::ModelFile& model,
                                       const scan::DecodingLimit& limit);

/// Colours a point by the best three pictures that see it, in linear light, by `cos^2 (focal length / distance)^2`,
/// less near the border of a picture. A point is seen if it is not more than `tolerance` behind the front surface.
Painter painter_of(const std::vector<Photo>& photos, double tolerance);

}  // namespace surfcast::colorize
