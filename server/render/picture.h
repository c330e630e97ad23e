#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.h"

namespace surfcast {

enum class Normalization { kPixel, kSurfel };
enum class Filter { kEwa, kNone };  ///< kNone leaves the prefilter out: the reconstruction kernel alone
enum class Shading { kAuto, kUnlit, kLit };

/// What a rendered pixel is: kSrgb8 for pictures, kLinearFloat for formats that hold measured light (EXR).
enum class PixelFormat { kSrgb8, kLinearFloat };

/// Everything that a picture of a model depends on.
struct PictureRequest {
  std::optional<Camera> camera;  ///< none: a view that fits the whole model
  int width = 1280;              ///< pixels
  int height = 720;              ///< pixels
  Normalization normalization = Normalization::kPixel;
  Filter filter = Filter::kEwa;
  Shading shading = Shading::kAuto;
  double spacing = 0;               ///< projected spacing of surfels to stop at, pixels; 0 is the finest level there is
  glm::u8vec3 background{0, 0, 0};  ///< sRGB
  PixelFormat format = PixelFormat::kSrgb8;
};

/// A rendered picture, rows from top to bottom without padding. Four channels; the fourth is the coverage of the
/// pixel by the model, the first three are already blended with the background.
struct Image {
  int width = 0;
  int height = 0;
  PixelFormat format = PixelFormat::kSrgb8;
  std::vector<std::byte> pixels;  ///< 4 x uint8_t or 4 x float per pixel
};

struct StageTime {
  std::string name;
  double milliseconds = 0;
};

/// What drawing a frame took.
struct FrameStats {
  uint64_t surfels_drawn = 0;
  uint32_t blocks_drawn = 0;
  std::string gl_renderer;
  std::vector<StageTime> stages;
};

struct Frame {
  Image image;
  Camera camera;  ///< the one that was used
  FrameStats stats;
};

}  // namespace surfcast
