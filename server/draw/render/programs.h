#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "gl/objects.h"
#include "kinds/kind.h"
#include "picture/picture.h"
#include "render/embedded_shaders.h"
#include "shared/frame_layout.h"
#include "shared/kernel.h"

namespace surfcast::render {

/// The features that a picture uses. Each combination has programs of its own, so a picture does not pay for features
/// that it does not use.
struct Variant {
  bool colored = false;  ///< surfels have colours, stored or from a table
  bool lit = false;
  bool float_picture = false;
  picture::SurfelColor color = picture::SurfelColor::kStored;
  bool hides_classes = false;
  bool clipped = false;
  bool scatter = false;  ///< the model has scatter
  bool curved = false;   ///< the model has surfels with curvature
  bool eye_dome = false;
  bool silhouettes = false;      ///< silhouettes are supersampled
  bool depth = false;            ///< the depth of the picture is asked for and known
  bool shown_depths = false;     ///< the depths that pixels show are kept; without silhouettes
  bool blends_behind = false;    ///< see PictureRequest::blends_behind
  bool transparent = false;      ///< surfels are seen through
  bool by_file = false;          ///< their opacities are those of the scan; with transparent
  bool by_class = false;         ///< their opacities depend on their classes; with transparent
  bool ghosts = false;           ///< those that are clipped have an opacity; with transparent
  bool xray = false;             ///< their opacities grow with the angle at which they are seen; with transparent
  bool density = false;          ///< they are a medium; with transparent
  bool shaded = false;           ///< volumes are lit
  bool volume_surfaces = false;  ///< volumes have iso-surfaces or slices
  bool layered = false;          ///< surfaces are kept for what is drawn between them; their own passes: with eye_dome
  bool codes = false;            ///< volumes are drawn between layers in sRGB codes; with layered
  bool keeps = false;            ///< Gaussians are kept as layers for volumes instead of drawn; with layered
  bool superquadrics = false;    ///< glyphs are superquadrics instead of ellipsoids
  bool exact = false;            ///< Gaussians are exact in perspective
  int harmonics = 4;             ///< highest degree of the harmonics of Gaussians that is evaluated

  /// The inverse depth of the front surface of each pixel is kept.
  [[nodiscard]] bool keeps_fronts() const { return silhouettes || depth; }
};

/// A kind that a picture shows.
struct PictureKind {
  const kinds::Kind* kind = nullptr;
  uint32_t number = 0;  ///< its index in the table of kinds
};
/// Sorted by number.
using PictureKinds = std::vector<PictureKind>;

/// The programs of a variant. They are valid as long as Programs.
struct SplatPrograms {
  std::vector<const gl::Program*> project;   ///< for each kind of the picture
  const gl::Program* splat = nullptr;        ///< for tiles without large splats or records of other kinds than surfels
  const gl::Program* splat_large = nullptr;  ///< for tiles with them
  /// Draw the columns that the programs without large splats hand over; null unless Programs::selects, and where
  /// surfels are seen through.
  const gl::Program* behind = nullptr;
  const gl::Program* behind_samples = nullptr;
  /// Null unless silhouettes are supersampled. The first finds them; the others draw them in tiles without and with
  /// large splats.
  const gl::Program* silhouettes = nullptr;
  const gl::Program* supersample = nullptr;
  const gl::Program* supersample_large = nullptr;
  int lanes_of_large_pixel = 1;           ///< of the last one
  const gl::Program* eye_dome = nullptr;  ///< null without eye-dome lighting
};

/// The mapping of the passes to the device's vectors. It does not affect pictures.
struct KernelShape {
  bool whole_tiles = false;   ///< a lane of the splat kernel holds a tile instead of a pixel (see include/rows.glsl),
                              ///< and continues with the next tile
  int tiles_at_once = 2;      ///< tiles that a work group of the splat kernel draws side by side
  int silhouette_lanes = 32;  ///< of a work group of the silhouette passes
  int project_lanes = 64;  ///< lanes that share a chunk of surfels: one vector, or as many as hide the memory latency
  bool interleaves_groups = false;  ///< threads take successive work groups of a batch (see include/work_group.glsl)
  bool shifted_halves = false;      ///< halves are converted without the built-in functions (see include/packing.glsl)

  /// Rows of a tile that a lane of the blending pass of Gaussians holds, if it does not hold one pixel.
  [[nodiscard]] int blend_rows() const { return whole_tiles ? SURFCAST_TILE_HEIGHT : 1; }
};

/// The programs for tiles with long lists, whose work groups draw one tile each.
struct LongListPrograms {
  const gl::Program* splat = nullptr;
  const gl::Program* splat_large = nullptr;        ///< for tiles with large splats
  const gl::Program* supersample = nullptr;        ///< null without silhouettes
  const gl::Program* supersample_large = nullptr;  ///< likewise
};

/// The programs for volumes.
struct VolumePrograms {
  const gl::Program* draw = nullptr;
  const gl::Program* filter_rows = nullptr;
  const gl::Program* filter_columns = nullptr;
};

/// The shape for devices whose lanes are those of a processor's vectors.
constexpr KernelShape software_kernels() {
  return {.whole_tiles = true,
          .tiles_at_once = 8,
          .silhouette_lanes = 16,
          .project_lanes = 8,
          .interleaves_groups = true,
          .shifted_halves = true};
}

/// How Gaussians are drawn: affine footprints, discs, or exact in perspective.
enum class GaussianForm { kTrained, kFlat, kExact };

/// The programs of pictures with Gaussians.
struct GaussianPrograms {
  const gl::Program* project = nullptr;
  const gl::Program* blend = nullptr;
  uint32_t record = 2;         ///< texels of a Gaussian on the screen
  uint32_t key = 1;            ///< texels of its key
  uint32_t round = 0;          ///< list entries that a lane draws in one dispatch
  uint32_t lanes_of_tile = 1;  ///< of the blending pass
  uint32_t lanes = 8;          ///< of its work groups
  bool has_near = false;       ///< the blending pass needs the depth of the nearest centre
  bool keeps = false;          ///< the blending pass writes layers
  bool layered = false;        ///< the blending pass reads the surfaces of the pixels
  bool keeps_fronts = false;   ///< the blending pass writes the depths of the pixels

  /// The blending pass reads the keys of the Gaussians.
  [[nodiscard]] bool needs_keys() const { return layered || keeps_fronts; }
};

/// Where ellipsoids go: into the picture, into a picture with surfaces, which are kept in layers, or among these
/// layers.
enum class EllipsoidTarget { kPicture, kBesideSurfaces, kLayers };

/// The programs of pictures with ellipsoids.
struct EllipsoidPrograms {
  const gl::Program* project = nullptr;
  const gl::Program* nearest = nullptr;  ///< finds the nearest ellipsoid of each sample
  const gl::Program* shade = nullptr;    ///< lights it
  const gl::Program* filter_rows = nullptr;
  const gl::Program* filter_columns = nullptr;
  bool keeps_fronts = false;   ///< `shade` writes the depths of the pixels
  uint32_t samples = 1;        ///< of a pixel
  uint32_t record = 1;         ///< texels of an ellipsoid on the screen
  uint32_t round = 1;          ///< list entries that a lane draws in one dispatch
  uint32_t lanes_of_tile = 1;  ///< of the pass that finds the nearest ones
  uint32_t lanes = 8;          ///< of its work groups
};

/// Compiles the passes when they are first needed.
class Programs {
 public:
  /// `defines` is prepended to every shader.
  static Result<Programs> create(const KernelShape& shape, const std::string& defines);

  Result<SplatPrograms> variant(const Variant& variant, const PictureKinds& kinds);
  /// `longest`: entries of the longest list.
  Result<LongListPrograms> long_lists(const Variant& variant, const PictureKinds& kinds, uint32_t longest);
  /// `volumes`: that the program has room for (room_for_volumes).
  Result<VolumePrograms> volumes(const Variant& variant, size_t volumes);
  Result<GaussianPrograms> gaussians(const Variant& variant, GaussianForm form);
  /// `mapped`: colours come from a table.
  Result<EllipsoidPrograms> ellipsoids(const Variant& variant, bool mapped, EllipsoidTarget target);
  /// Counts the tiles that large splats touch.
  [[nodiscard]] const gl::Program& count_large() const { return count_large_; }
  [[nodiscard]] const gl::Program& slices() const { return slices_; }
  [[nodiscard]] const gl::Program& bin_offsets() const { return bin_offsets_; }
  [[nodiscard]] const gl::Program& bin(const Variant& variant) const { return selects(variant) ? bin_reaches_ : bin_; }
  /// True if lanes draw from the list entries that matter (include/selection.glsl). This pays off where a lane holds
  /// many pixels, and silhouettes are supersampled or several surfaces of a pixel are seen.
  [[nodiscard]] bool selects(const Variant& variant) const {
    return (variant.silhouettes || variant.transparent) && shape_.whole_tiles;
  }
  /// Pixels of a tile that a lane of supersample.comp draws at once.
  [[nodiscard]] int pixels_at_once() const;
  [[nodiscard]] const KernelShape& shape() const { return shape_; }
  /// The names of the compiled programs. A name includes the kinds, other than surfels, that the program supports.
  [[nodiscard]] std::vector<std::string> compiled() const;

 private:
  /// A shader with the files that kinds add to it.
  struct Source {
    std::string name;                        ///< file name and kinds
    std::string file;                        ///< file to compile
    std::vector<EmbeddedShader> files = {};  ///< additional files to those of shaders/
  };

  Result<const gl::Program*> program(const Source& source, const std::string& defines);
  Result<std::vector<const gl::Program*>> projections(const Variant& variant, const PictureKinds& kinds);

  KernelShape shape_;
  std::string defines_;
  gl::Program count_large_;
  gl::Program slices_;
  gl::Program bin_offsets_;
  gl::Program bin_;
  gl::Program bin_reaches_;                                              ///< also stores the reaches of list entries
  std::map<std::pair<std::string, std::string>, gl::Program> compiled_;  ///< by Source::name and defines
};

}  // namespace surfcast::render
