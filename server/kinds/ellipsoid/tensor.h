#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace surfcast::ellipsoid {

/// A symmetric tensor of the second order.
struct SymmetricTensor {
  double xx = 0;
  double xy = 0;
  double xz = 0;
  double yy = 0;
  double yz = 0;
  double zz = 0;

  [[nodiscard]] glm::dmat3 matrix() const { return {{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}; }
};

/// Eigenvalues and the directions that belong to them.
struct EigenSystem {
  glm::dvec3 values{0};  ///< descending
  glm::dmat3 axes{1};    ///< columns: unit eigenvectors, right-handed
  bool operator==(const EigenSystem&) const = default;
};

/// The symmetric part of a matrix.
[[nodiscard]] SymmetricTensor symmetric_part(const glm::dmat3& matrix);
/// M D M^T: a tensor whose axes are the columns of M, in the world.
[[nodiscard]] SymmetricTensor turned(const SymmetricTensor& tensor, const glm::dmat3& frame);
/// R diag(values) R^T.
[[nodiscard]] SymmetricTensor tensor_of(const glm::dvec3& values, const glm::dmat3& axes);

/// Cyclic Jacobi rotations (Golub and Van Loan, Matrix Computations, section 8.5) of the tensor divided by its largest
/// entry: the error of values and of R diag R^T is a few roundings of that entry, whatever the eigenvalues. All entries
/// are finite. Equal eigenvalues leave their axes open; those of a diagonal tensor are those of the world.
[[nodiscard]] EigenSystem eigen_system(const SymmetricTensor& tensor);

/// sqrt(3/2) |D'| / |D|, D' the deviator: 0 to 1 unless values are negative. 0 for a tensor of 0.
[[nodiscard]] double fractional_anisotropy(const glm::dvec3& values);
/// 3 sqrt(6) det(D' / |D'|): -1 for discs, 1 for needles (Ennis and Kindlmann 2006). 0 for an isotropic tensor.
[[nodiscard]] double mode_of(const glm::dvec3& values);
/// A third of the trace: the mean diffusivity of diffusion tensors.
[[nodiscard]] double mean_value(const glm::dvec3& values);

}  // namespace surfcast::ellipsoid
