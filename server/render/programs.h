#pragma once

#include <map>
#include <string>

#include "base/result.h"
#include "gl/objects.h"
#include "picture/picture.h"

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

/// The programs of a variant; they live as long as Programs.
struct SplatPrograms {
  const gl::Program* project = nullptr;
  const gl::Program* splat = nullptr;        ///< tiles without large splats
  const gl::Program* splat_large = nullptr;  ///< tiles with large splats
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

/// Compiles the passes when they are first needed.
class Programs {
 public:
  /// `defines` stands before every shader.
  static Result<Programs> create(const KernelShape& shape, const std::string& defines);

  Result<SplatPrograms> variant(const Variant& variant);
  [[nodiscard]] const gl::Program& bin_offsets() const { return bin_offsets_; }
  [[nodiscard]] const gl::Program& bin() const { return bin_; }
  /// Pixels of a tile that a lane of supersample.comp draws at once.
  [[nodiscard]] int pixels_at_once() const;
  [[nodiscard]] const KernelShape& shape() const { return shape_; }

 private:
  Result<const gl::Program*> program(const char* name, const std::string& defines);

  KernelShape shape_;
  std::string defines_;
  gl::Program bin_offsets_;
  gl::Program bin_;
  std::map<std::string, gl::Program> compiled_;  ///< by name and defines
};

}  // namespace surfcast::render
