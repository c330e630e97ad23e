#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "scan/gltf_buffers.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// The points of a glTF file: primitives of the mode POINTS in the scene that it shows, depth first, with the matrices
/// of their nodes. Colours are sRGB, of 8 bits where all are stored with 8 and no material changes them, else of 16.
/// Scalar attributes of applications (`_NAME`) are columns.
class GltfPoints {
 public:
  /// `bytes`, of the file `path`, must outlive the object. Nothing is decoded yet.
  static Result<GltfPoints> open(std::span<const std::byte> bytes, const std::filesystem::path& path,
                                 const DecodingLimit& limit);

  [[nodiscard]] const std::vector<ColumnInfo>& columns() const { return columns_; }  ///< none without a point
  [[nodiscard]] uint64_t points() const { return points_; }
  [[nodiscard]] bool others() const { return others_; }  ///< it has triangles or lines, too
  /// What the positions are relative to (CESIUM_RTC), with z up.
  [[nodiscard]] const std::optional<glm::dvec3>& centre() const { return centre_; }

  /// All points in those columns, the transform applied. Refers to nothing else. Thread-safe.
  [[nodiscard]] Result<PointTable> table(const glm::dmat4& transform) const;

 private:
  /// A primitive at a node.
  struct Part {
    const Json* stated = nullptr;
    glm::dmat4 to_world{1};
    uint64_t points = 0;
    glm::vec3 factor{1};  ///< of its material, linear
  };

  GltfPoints(GltfParts parts, GltfBuffers buffers);
  Status add_node(const Json& node, const glm::dmat4& to_world);
  Status add_primitive(const Json& stated, const glm::dmat4& to_world);
  void find_columns();
  [[nodiscard]] const Json& accessor_of(const Json& stated, const std::string& attribute) const;

  std::unique_ptr<const GltfParts> parts_;  ///< parts of the scene point into it
  GltfBuffers buffers_;
  std::vector<Part> scene_;
  std::vector<ColumnInfo> columns_;
  std::vector<std::string> scalars_;  ///< attributes of the last columns
  uint64_t points_ = 0;
  int color_bits_ = 0;
  bool normals_ = false;
  bool others_ = false;
  std::optional<glm::dvec3> centre_;
};

/// The transform from the frame of glTF, with y up, to that of 3D Tiles, with z up.
[[nodiscard]] glm::dmat4 y_up_to_z_up();

/// True for glTF, as text or binary, that has points and no triangles.
bool is_gltf_of_points(std::span<const std::byte> bytes);

/// The points of a file alone, in its own frame: y is up, but for what is relative to a centre.
Result<std::unique_ptr<RowSource>> gltf_rows(std::span<const std::byte> bytes, const std::filesystem::path& path,
                                             const DecodingLimit& limit);

}  // namespace surfcast::scan
