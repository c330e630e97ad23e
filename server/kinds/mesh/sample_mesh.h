#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "mesh/mesh.h"
#include "scan/row_source.h"

namespace surfcast::mesh {

/// More surfels than that are too many unless somebody asks for them.
inline constexpr uint64_t kMaxSurfels = 200'000'000;

struct SampleOptions {
  /// Distance of surfels, world units; textures are sampled at the power of two times or part of a texel that is
  /// nearest. None: one surfel a texel, and 1/1500 of the diagonal where there is no texture, or more for meshes of few
  /// triangles (docs/textured-models.md).
  std::optional<double> spacing{};
  uint64_t most_surfels = kMaxSurfels;  ///< distances are doubled until there are no more
};

/// A point of a mesh.
struct MeshSurfel {
  glm::dvec3 position{0};
  glm::vec3 normal{0};   ///< unit
  float radius = 0;      ///< world units
  glm::u8vec3 color{0};  ///< sRGB
  uint8_t alpha = 255;   ///< opacity
};

/// What became of a mesh.
struct MeshReport {
  uint64_t triangles = 0;
  uint64_t textured = 0;  ///< surfels of triangles with a texture
  uint64_t surfels = 0;
  double texels = 0;    ///< covered by triangles, of textures as often as they are repeated
  uint64_t masked = 0;  ///< left out, because alpha is below the cutoff or 0
  uint64_t images = 0;
  uint64_t images_missing = 0;
  double widest = 0;       ///< largest distance of neighbouring surfels, world units
  bool two_sided = false;  ///< some surfaces are seen from both sides
  bool colors = false;     ///< some surfel has a colour of its own
  bool blended = false;    ///< some surfel is not opaque
  std::vector<std::string> notes;
};

/// Takes surfels in their order, in runs of bounded size.
using TexelSink = std::function<Status(std::span<const MeshSurfel>)>;

/// Makes surfels of a mesh: one at the centre of each texel of a triangle, with the texel's colour (Zwicker et al.
/// 2002, section 6.4: splats of texels are the texture, filtered). Textures are decoded one after another. The surfels
/// do not depend on the number of threads. Fails where `limit` leaves no memory for any
/// of the textures.
Result<MeshReport> sample_mesh(const Mesh& mesh, const SampleOptions& options, const scan::DecodingLimit& limit,
                               const TexelSink& sink);

}  // namespace surfcast::mesh
