#pragma once

#include <map>
#include <tuple>

#include "base/result.h"
#include "gl/objects.h"

namespace surfcast {

/// What a scene has and needs: each combination is a program of its own, so that a scene without a feature does not
/// pay for it.
struct Variant {
  bool colored = false;
  bool lit = false;
  bool float_picture = false;

  bool operator<(const Variant& other) const {
    return std::tie(colored, lit, float_picture) < std::tie(other.colored, other.lit, other.float_picture);
  }
};

struct SplatPrograms {
  gl::Program project;
  gl::Program splat;        ///< tiles without large splats
  gl::Program splat_large;  ///< tiles with large splats
};

/// Compiles the passes when they are first needed.
class Programs {
 public:
  /// `rows` is the number of pixels that a lane of the splat kernel holds, 1 or 4 (see include/rows.glsl).
  static Result<Programs> create(int rows);

  Result<const SplatPrograms*> variant(const Variant& variant);
  [[nodiscard]] const gl::Program& bin_offsets() const { return bin_offsets_; }
  [[nodiscard]] const gl::Program& bin() const { return bin_; }

 private:
  int rows_ = 1;
  gl::Program bin_offsets_;
  gl::Program bin_;
  std::map<Variant, SplatPrograms> variants_;
};

}  // namespace surfcast
