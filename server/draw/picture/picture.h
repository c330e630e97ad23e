#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "geometry/clip.h"
#include "picture/depth_map.h"
#include "picture/glyphs.h"
#include "picture/plain_options.h"
#include "picture/transfer.h"

namespace surfcast::picture {

/// Whether a picture waits for missing blocks. kNow draws the resident blocks only and leaves the others to later
/// pictures of the view.
enum class Loading { kWait, kNow };

/// The pixel format of a rendered picture: kSrgb8 for display, kLinearFloat for linear light (EXR).
enum class PixelFormat { kSrgb8, kLinearFloat };

/// The quantity that determines the colour of a surfel. The last three are of ellipsoids: the principal direction; it
/// and the anisotropy, as in radiology; an attribute by name. Surfels keep their own colours then.
enum class SurfelColor { kStored, kIntensity, kElevation, kClassification, kNormal, kDirection, kDec, kAttribute };
enum class ColorMap { kViridis, kTurbo, kGray, kTerrain };

struct Coloring {
  SurfelColor source = SurfelColor::kStored;
  ColorMap map = ColorMap::kViridis;  ///< for intensity and elevation
  std::optional<double> first{};      ///< the value at the start of the colour map; none: the model's lowest
  std::optional<double> last{};       ///< the value at the end of the colour map; none: the model's highest
  std::string attribute{};            ///< of kAttribute: see Threshold::attribute
};

/// Eye-dome lighting (Boucheny 2009): darkens surfaces behind a depth discontinuity.
struct EyeDome {
  double strength = 0;  ///< 0: off; 1: usual
  double radius = 1.5;  ///< pixels, at most 8
};

/// The opacity of the surfels of a class.
struct ClassOpacity {
  uint8_t code = 0;
  double opacity = 1;
};

/// What else a picture is asked for: the view, what only the server decides, and the options with a structure.
struct PictureParameters {
  std::optional<geometry::Camera> camera;  ///< none: a view that fits the whole model
  int width = 1280;                        ///< pixels
  int height = 720;                        ///< pixels
  /// Supersamples the pixels at silhouettes (docs/kernel.md). Only under per-pixel normalisation, and only in pictures
  /// that are not about to be redrawn.
  bool silhouettes = false;
  /// Blends all that is behind the front surface of a pixel as if it were one surface, for pictures in motion.
  bool blends_behind = false;
  /// Surveys the picture however few surfels it has (see render/survey.h): for tests and the warm-up of shaders.
  bool surveyed = false;
  PixelFormat format = PixelFormat::kSrgb8;
  Loading loading = Loading::kWait;
  uint64_t edition = 0;  ///< of a scan's model, see ModelSource::edition; 0: the newest
  uint64_t viewer = 0;   ///< with kNow: the viewer whose motion this is, or 0; keys state that is kept between pictures
  /// With a viewer: the `spacing` of the picture that follows when the motion ends, in pixels of this picture.
  std::optional<double> rest_spacing{};
  uint64_t displayed_cut = 0;  ///< with kNow: Frame::cut of a picture that need not be drawn again; 0: none
  /// With kNow: the picture is not drawn while more blocks than this are missing and still loading.
  uint32_t max_missing_blocks = std::numeric_limits<uint32_t>::max();
  Coloring coloring;
  std::bitset<256> hidden_classes;  ///< hidden classification codes; no effect on models without classes
  geometry::Clip clip;
  EyeDome eye_dome;
  VolumeOptions volumes;
  GlyphOptions glyphs;
  Lighting lighting;  ///< of ellipsoids
  /// Further factors for the surfels of a class, from 0 to 1; of several with the same code the last one counts. No
  /// effect on models without classes.
  std::vector<ClassOpacity> class_opacities;
  std::vector<std::string> hidden_models;  ///< members of a joined model that are not shown, by name
  int depth_texels = 0;                    ///< a side of Frame::depth, at most; 0: none. Does not change the picture.
};

/// All parameters of a picture of a model.
struct PictureRequest : PlainOptions, PictureParameters {};

/// Whether the spacing of a picture is to be chosen for an error or a time.
inline bool has_budget(const PictureRequest& request) {
  return request.error > 0 || request.time_ms > 0;
}

/// A rendered picture. Rows run from top to bottom without padding. Each pixel has four channels: the colour, already
/// blended with the background, and the pixel's coverage by the model.
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
  uint32_t selected = 0;  ///< blocks of this level that the picture requires
  uint32_t drawn = 0;     ///< blocks of this level that were drawn
};

/// Statistics of one frame.
struct FrameStats {
  uint64_t surfels_drawn = 0;  ///< splats after culling
  uint32_t blocks_drawn = 0;
  uint32_t blocks_selected = 0;    ///< blocks that the picture requires
  uint32_t holes = 0;              ///< parts of the view without any resident block
  uint32_t blocks_waited_for = 0;  ///< blocks that were not resident when the picture was requested
  uint32_t blocks_missing = 0;     ///< blocks that would refine the picture and are not resident
  uint32_t blocks_resident = 0;    ///< blocks in GPU memory afterwards, of all models
  uint64_t bytes_resident = 0;     ///< GPU memory of the resident blocks
  std::vector<LevelStats> levels;  ///< levels with at least one block, finest first
  std::string gl_renderer;
  std::vector<StageTime> stages;
};

struct Frame {
  Image image;  ///< without pixels if PictureRequest::displayed_cut or max_missing_blocks made drawing pointless
  geometry::Camera camera;  ///< the camera that was used
  /// True if no later picture of the same request can be better: every required block is drawn, and the budget of GPU
  /// memory did not coarsen any part.
  bool converged = false;
  bool nothing_pending = false;  ///< no missing block is about to arrive: redrawing would not improve the frame
  uint64_t cut = 0;              ///< identifies the set of blocks drawn
  double spacing = 0;            ///< of the picture, see PictureRequest::spacing
  double render_scale = 1;       ///< likewise
  double expected_error = 0;     ///< with PictureRequest::error or time_ms: the PSNR expected, dB; 0: not known
  double expected_ms = 0;        ///< likewise: the time of drawing, milliseconds
  bool preview = false;          ///< of a scan whose model is still being built
  DepthMap depth;                ///< with PictureRequest::depth_texels, of pictures of opaque surfaces alone
  FrameStats stats;
};

}  // namespace surfcast::picture
