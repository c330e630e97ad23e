#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "geometry/clip.h"

namespace surfcast::picture {

enum class Normalization { kPixel, kSurfel };
enum class Filter { kEwa, kNone };  ///< kNone leaves the prefilter out: the reconstruction kernel alone
enum class Shading { kAuto, kUnlit, kLit };

/// Whether a picture waits for the blocks that it should show. kNow draws what is there and leaves the rest to later
/// pictures, for views in motion.
enum class Loading { kWait, kNow };

/// What a rendered pixel is: kSrgb8 for pictures, kLinearFloat for formats that hold measured light (EXR).
enum class PixelFormat { kSrgb8, kLinearFloat };

/// What the colour of a surfel shows.
enum class SurfelColor { kStored, kIntensity, kElevation, kClassification, kNormal };
enum class ColorMap { kViridis, kTurbo, kGray, kTerrain };

struct Coloring {
  SurfelColor source = SurfelColor::kStored;
  ColorMap map = ColorMap::kViridis;  ///< of intensity and elevation
  std::optional<double> first{};      ///< the value that takes the first colour of the map; none: the model's low
  std::optional<double> last{};       ///< the value that takes the last one; none: the model's high
};

/// Eye-dome lighting (Boucheny 2009): what lies behind an edge of depth is darkened.
struct EyeDome {
  double strength = 0;  ///< 0: none; 1: usual
  double radius = 1.5;  ///< pixels, at most 8
};

/// Everything that a picture of a model depends on.
struct PictureRequest {
  std::optional<geometry::Camera> camera;  ///< none: a view that fits the whole model
  int width = 1280;                        ///< pixels
  int height = 720;                        ///< pixels
  Normalization normalization = Normalization::kPixel;
  Filter filter = Filter::kEwa;
  Shading shading = Shading::kAuto;
  /// Draws the pixels at silhouettes as means of samples (docs/kernel.md), under per-pixel normalisation and in
  /// pictures that will not soon be drawn again.
  bool silhouettes = false;
  double spacing = 0;               ///< projected spacing of surfels to stop at, pixels; 0 is the finest level there is
  glm::u8vec3 background{0, 0, 0};  ///< sRGB
  PixelFormat format = PixelFormat::kSrgb8;
  Loading loading = Loading::kWait;
  uint64_t viewer = 0;  ///< with kNow: whose motion this is, or 0; things are remembered from picture to picture
  /// With a viewer: what `spacing` will be, in pixels of this picture, of the one that follows when the movement ends.
  std::optional<double> rest_spacing{};
  uint64_t displayed_cut = 0;  ///< with kNow: Frame::cut of a picture that needs no repeating; 0: none
  /// With kNow: the picture is not worth drawing while it would miss more blocks that are still to come.
  uint32_t max_missing_blocks = std::numeric_limits<uint32_t>::max();
  Coloring coloring;
  std::bitset<256> hidden_classes;  ///< by code: surfels that are not drawn; models without classes have none
  geometry::Clip clip;
  EyeDome eye_dome;
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

/// Blocks of one level of detail.
struct LevelStats {
  int level = 0;          ///< 0 is the finest
  uint32_t selected = 0;  ///< blocks of this level that the picture should show
  uint32_t drawn = 0;     ///< blocks of this level that it does show
};

/// What drawing a frame took.
struct FrameStats {
  uint64_t surfels_drawn = 0;  ///< splats, once what faces away or lies outside has been left out
  uint32_t blocks_drawn = 0;
  uint32_t blocks_selected = 0;    ///< that the picture should show
  uint32_t holes = 0;              ///< parts of the view for which no block is there
  uint32_t blocks_waited_for = 0;  ///< that were not resident when it was asked for
  uint32_t blocks_missing = 0;     ///< that would make it better and are not there
  uint32_t blocks_resident = 0;    ///< on the GPU afterwards, of all models
  uint64_t bytes_resident = 0;     ///< of GPU memory that they take
  std::vector<LevelStats> levels;  ///< those with a block, finest first
  std::string gl_renderer;
  std::vector<StageTime> stages;
};

struct Frame {
  Image image;  ///< without pixels where PictureRequest::displayed_cut or max_missing_blocks say that it is not worth
                ///< drawing
  geometry::Camera camera;  ///< the one that was used
  /// True if no later picture of the same request would be better: every block that it should show is drawn, and the
  /// budget of GPU memory left none of them coarser than was asked for.
  bool converged = false;
  bool nothing_pending = false;  ///< nothing that it misses is about to come: drawing it again would not make it better
  uint64_t cut = 0;              ///< stands for the blocks that it shows
  FrameStats stats;
};

}  // namespace surfcast::picture
