#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/box.h"

namespace surfcast::mesh {

/// What texture coordinates beyond the image mean, for one axis.
enum class Wrap : uint8_t { kRepeat, kMirror, kClamp };

enum class AlphaMode : uint8_t {
  kOpaque,  ///< alpha is ignored
  kMask,    ///< what is below the cutoff is not there
  kBlend,   ///< alpha is opacity
};

/// An encoded image: a file, or a part of the model's own file.
struct ImageSource {
  std::string name;                        ///< for messages
  std::filesystem::path file;              ///< empty if `bytes` hold it
  std::span<const std::byte> bytes;        ///< within what Mesh::contents keep
  std::optional<std::string> unavailable;  ///< why it cannot be read, known beforehand
};

/// Where an image of opacities states them.
enum class OpacityChannel : uint8_t {
  kAuto,  ///< alpha if any texel is not opaque, else luminance
  kRed,
  kGreen,
  kBlue,
  kLuminance,
};

/// An image of opacities, which counts beside the alpha of colours.
struct OpacityMap {
  size_t image = 0;  ///< of Mesh::images; may be that of the colours
  OpacityChannel channel = OpacityChannel::kAuto;
};

struct Material {
  std::string name;
  glm::vec4 color{1};           ///< linear light and alpha; a factor on the texture
  std::optional<size_t> image;  ///< of Mesh::images; its colours are sRGB
  std::optional<OpacityMap> opacity;
  std::array<Wrap, 2> wrap{};  ///< along u and v, of all images
  glm::vec4 without_image{1};  ///< takes the place of `color` if the image is missing
  AlphaMode alpha = AlphaMode::kOpaque;
  float cutoff = 0.5F;  ///< of kMask
  bool culled = false;  ///< back faces are not shown
};

inline constexpr uint32_t kNone = UINT32_MAX;

/// Indices into Vertices; kNone where a file states none.
struct Corner {
  uint32_t position = kNone;
  uint32_t normal = kNone;
  uint32_t uv = kNone;
};

using Triangle = std::array<Corner, 3>;

struct Vertices {
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals;  ///< of any length
  std::vector<glm::dvec2> uvs;     ///< (0, 0) is the corner of the image's first pixel; v counts downwards
  std::vector<glm::vec4> colors;   ///< of the positions: linear light and alpha; empty without
};

/// Triangles of one material in one place. Instances share vertices and triangles.
struct Patch {
  std::shared_ptr<const Vertices> vertices;
  std::shared_ptr<const std::vector<Triangle>> triangles;
  size_t material = 0;
  glm::dmat4 to_world{1};
};

/// A mesh of triangles as a file states it. All indices are within their arrays, all positions are finite.
struct Mesh {
  std::vector<Patch> patches;
  std::vector<Material> materials;
  std::vector<ImageSource> images;
  std::vector<std::string> notes;  ///< what was left out
  bool z_up = false;
  std::vector<std::shared_ptr<const void>> contents;  ///< keep what images lie in

  [[nodiscard]] uint64_t triangles() const;
  /// True if the file states any colour. What has none is drawn with light instead.
  [[nodiscard]] bool colored() const;
  [[nodiscard]] geometry::Box bounds() const;  ///< in the world
};

}  // namespace surfcast::mesh
