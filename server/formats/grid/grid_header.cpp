#include "grid/grid_header.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace surfcast::grid {
namespace {

bool is_finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Status check_sizes(const GridHeader& header) {
  uint64_t bytes = header.sample_bytes();
  for (const uint64_t size : header.size) {
    if (size == 0) return fail(ErrorKind::kInvalidInput, "the grid has no samples: a size is 0");
    if (__builtin_mul_overflow(bytes, size, &bytes)) {
      return fail(ErrorKind::kInvalidInput, "the sizes of the grid overflow 64 bits");
    }
  }
  return {};
}

/// The determinant of the unit axes: 1 if they are at right angles, 0 if they lie in a plane.
double spanned_volume(const glm::dmat4x3& affine) {
  const glm::dmat3 axes(affine[0], affine[1], affine[2]);
  const double lengths = glm::length(axes[0]) * glm::length(axes[1]) * glm::length(axes[2]);
  return std::abs(glm::determinant(axes)) / lengths;
}

}  // namespace

uint32_t components_of(SampleKind kind) {
  switch (kind) {
    case SampleKind::kScalar:
      break;
    case SampleKind::kSymmetricTensor:
    case SampleKind::kSymmetricTensorLower:
    case SampleKind::kSymmetricTensorVtk:
    case SampleKind::kSymmetricTensorMrtrix:
      return 6;
    case SampleKind::kMaskedSymmetricTensor:
      return 7;
    case SampleKind::kTensor:
      return 9;
    case SampleKind::kMaskedTensor:
      return 10;
  }
  return 1;
}

Status check_header(const GridHeader& header) {
  if (Status status = check_sizes(header); !status) return status;
  for (int column = 0; column < 4; ++column) {
    if (!is_finite(header.index_to_world[column])) {
      return fail(ErrorKind::kInvalidInput, "the position of the grid is not finite");
    }
  }
  // Rounded axes of real files are at least some degrees apart.
  constexpr double kFlat = 1e-9;
  if (!(spanned_volume(header.index_to_world) > kFlat)) {
    return fail(ErrorKind::kInvalidInput, "the axes of the grid do not span space: a spacing is 0 or axes coincide");
  }
  if (!std::isfinite(header.slope) || !std::isfinite(header.intercept) || header.slope == 0) {
    return fail(ErrorKind::kInvalidInput, "the scale of the samples is 0 or not finite");
  }
  return {};
}

glm::dmat4x3 affine(const glm::dmat3& directions, const glm::dvec3& spacing, const glm::dvec3& origin) {
  return {directions[0] * spacing.x, directions[1] * spacing.y, directions[2] * spacing.z, origin};
}

}  // namespace surfcast::grid
