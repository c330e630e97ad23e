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

namespace surfcast::render {

/// What a picture has and needs: each combination is a program of its own, so that a picture without a feature does
/// not pay for it.
struct Variant {
  bool colored = false;  ///< surfels have a colour of some kind
  bool lit = false;
  bool float_picture = false;
  picture::SurfelColor color = picture::SurfelColor::kStored;
  bool hides_classes = false;
  bool clipped = false;
  bool eye_dome = false;
  bool silhouettes = false;  ///< drawn again, as means of samples
};

/// A kind that a picture shows.
struct PictureKind {
  const kinds::Kind* kind = nullptr;
  uint32_t number = 0;  ///< its place in the table of kinds
};
/// By number.
using PictureKinds = std::vector<PictureKind>;

/// The programs of a variant; they live as long as Programs.
struct SplatPrograms {
  std::vector<const gl::Program*> project;   ///< of each kind of the picture
  const gl::Program* splat = nullptr;        ///< tiles without large splats, and without other kinds than surfels
  const gl::Program* splat_large = nullptr;  ///< tiles with such
  /// Null unless silhouettes are drawn again: what finds them, and what draws them in tiles without and with large
  /// splats.
  const gl::Program* silhouettes = nullptr;
  const gl::Program* supersample = nullptr;
  const gl::Program* supersample_large = nullptr;
  const gl::Program* eye_dome = nullptr;  ///< null without eye-dome lighting
};

/// How the passes fit the device's vectors. No picture depends on it.
struct KernelShape {
  bool whole_tiles = false;  ///< a lane of the splat kernel holds a tile instead of a pixel (see include/rows.glsl),
                             ///< and then another one
  int tiles_at_once = 2;     ///< that a work group of the splat kernel draws side by side
  int project_lanes = 64;    ///< lanes that share a chunk of surfels: one vector, or as many as hide waiting
};

/// The shape for devices whose lanes are those of a processor's vectors.
constexpr KernelShape software_kernels() {
  return {.whole_tiles = true, .tiles_at_once = 8, .project_lanes = 8};
}

/// Compiles the passes when they are first needed.
class Programs {
 public:
  /// `defines` stands before every shader.
  static Result<Programs> create(const KernelShape& shape, const std::string& defines);

  Result<SplatPrograms> variant(const Variant& variant, const PictureKinds& kinds);
  [[nodiscard]] const gl::Program& bin_offsets() const { return bin_offsets_; }
  [[nodiscard]] const gl::Program& bin() const { return bin_; }
  /// Pixels of a tile that a lane of supersample.comp draws at once.
  [[nodiscard]] int pixels_at_once() const;
  [[nodiscard]] const KernelShape& shape() const { return shape_; }
  /// What was compiled, each with the kinds besides surfels that it is of.
  [[nodiscard]] std::vector<std::string> compiled() const;

 private:
  /// A shader with what its kinds add to it.
  struct Source {
    std::string name;                        ///< of its file, and the kinds
    std::string file;                        ///< what is compiled
    std::vector<EmbeddedShader> files = {};  ///< besides those of shaders/
  };

  Result<const gl::Program*> program(const Source& source, const std::string& defines);
  Result<std::vector<const gl::Program*>> projections(const Variant& variant, const PictureKinds& kinds);

  KernelShape shape_;
  std::string defines_;
  gl::Program bin_offsets_;
  gl::Program bin_;
  std::map<std::pair<std::string, std::string>, gl::Program> compiled_;  ///< by Source::name and defines
};

}  // namespace surfcast::render
