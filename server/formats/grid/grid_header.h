#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x3.hpp>
#include <optional>
#include <string>

#include "base/result.h"
#include "scan/scalar_type.h"

namespace surfcast::grid {

using scan::ScalarType;

/// What the components of a sample are. The order of a tensor's components is the file's.
enum class SampleKind {
  kScalar,
  kSymmetricTensor,        ///< xx xy xz yy yz zz
  kSymmetricTensorLower,   ///< xx xy yy xz yz zz (NIfTI)
  kSymmetricTensorVtk,     ///< xx yy zz xy yz xz
  kSymmetricTensorMrtrix,  ///< xx yy zz xy xz yz
  kMaskedSymmetricTensor,  ///< confidence, then as kSymmetricTensor
  kTensor,                 ///< nine, row by row
  kMaskedTensor,           ///< confidence, then as kTensor
};

[[nodiscard]] uint32_t components_of(SampleKind kind);

/// The order and the axes of six components for which a file states none, as their writers have them.
enum class TensorOrder {
  kLower,   ///< xx xy yy xz yz zz, the lower triangle by rows, in the axes of the world
  kFsl,     ///< xx xy xz yy yz zz, in the axes of the grid, the first one turned where they are right-handed
  kMrtrix,  ///< xx yy zz xy xz yz, in the axes of the world
};

/// The directions of the axes x, y and z of the world, where a file states them: R or L, A or P, S for right or left,
/// anterior or posterior, superior.
enum class WorldFrame { kUnstated, kRas, kLas, kLps };

/// What a file states about its samples.
struct GridHeader {
  std::string format;              ///< for a person: "NRRD"
  std::string name;                ///< of the content or of the array; may be empty
  std::array<uint64_t, 3> size{};  ///< samples along i, j and k; i is the fastest
  ScalarType type = ScalarType::kUint8;
  SampleKind kind = SampleKind::kScalar;
  double slope = 1;  ///< value = slope * sample + intercept
  double intercept = 0;
  /// From indices (i, j, k) to the world: steps along the three axes, in world units, and the centre of sample (0, 0,
  /// 0). Steps may be negative, of different lengths, and oblique; they span space.
  glm::dmat4x3 index_to_world{1.0};
  WorldFrame frame = WorldFrame::kUnstated;
  std::string length_unit;                      ///< of the world, "mm" for example; empty where the file does not say
  std::string sample_unit;                      ///< of slope * sample + intercept; empty where the file does not say
  std::optional<glm::dmat3> measurement_frame;  ///< columns: the axes of tensors in the world

  [[nodiscard]] uint64_t samples() const { return size[0] * size[1] * size[2]; }
  [[nodiscard]] uint32_t components() const { return components_of(kind); }
  [[nodiscard]] size_t sample_bytes() const { return components() * scan::size_of(type); }
};

/// An error if the sizes are zero or their product overflows, or if numbers are not finite or the axes do not span
/// space.
[[nodiscard]] Status check_header(const GridHeader& header);

/// Steps along the columns of `directions`, each by its spacing, and the position of sample (0, 0, 0).
[[nodiscard]] glm::dmat4x3 affine(const glm::dmat3& directions, const glm::dvec3& spacing, const glm::dvec3& origin);

}  // namespace surfcast::grid
