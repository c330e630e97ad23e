// make_tensors SIDE FILE.nrrd: writes a generated field of SIDE^3 tensors over a cube of side 1, all of them drawn.
//
// The field is the same for any number of samples: bundles of fibres that wind about the middle of the cube, needles
// along them, discs between them, and balls near the border. Planes are streamed, so that a field may be larger than
// memory.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <string>

#include "write_cube.h"

namespace {

static_assert(std::endian::native == std::endian::little);

/// xx xy xz yy yz zz.
using Tensor = std::array<float, 6>;

/// The direction of the fibres at a place from -1 to 1 along each axis.
glm::dvec3 fibre(const glm::dvec3& p) {
  const glm::dvec3 around(-p.y, p.x, 0.3 + 0.4 * std::sin(5 * p.x - 3 * p.z));
  const glm::dvec3 bent(std::sin(4 * p.z), std::cos(3 * p.x + p.y), std::sin(4 * p.y));
  return glm::normalize(around + 0.35 * bent + glm::dvec3(0, 0, 1e-3));
}

/// Eigenvalues, descending: needles in bundles, discs between them, balls towards the border.
glm::dvec3 eigenvalues(const glm::dvec3& p) {
  const double bundle = 0.5 + 0.5 * std::sin(9 * p.x + 2 * p.z) * std::cos(8 * p.y - p.x);
  const double round = std::clamp(glm::length(p) - 0.7, 0.0, 1.0);
  const double across = 0.25 + 0.6 * round;
  return {1, std::max(across, 0.9 * (1 - bundle)), across};
}

Tensor tensor_at(const glm::dvec3& p) {
  const glm::dvec3 first = fibre(p);
  const glm::dvec3 aside = std::abs(first.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 second = glm::normalize(glm::cross(first, aside));
  const glm::dvec3 third = glm::cross(first, second);
  const glm::dvec3 values = 1e-3 * eigenvalues(p);
  const glm::dmat3 t = values.x * glm::outerProduct(first, first) + values.y * glm::outerProduct(second, second) +
                       values.z * glm::outerProduct(third, third);
  return {float(t[0][0]), float(t[1][0]), float(t[2][0]), float(t[1][1]), float(t[2][1]), float(t[2][2])};
}

Tensor sample_at(uint64_t i, uint64_t j, uint64_t k, uint64_t side) {
  const auto place = [side](uint64_t n) { return (2 * static_cast<double>(n) + 1) / static_cast<double>(side) - 1; };
  return tensor_at({place(i), place(j), place(k)});
}

std::string header_of(uint64_t side) {
  const std::string count = std::to_string(side);
  const std::string step = std::to_string(1 / static_cast<double>(side));
  return "NRRD0005\ntype: float\ndimension: 4\nsizes: 6 " + count + " " + count + " " + count +
         "\nspace: right-anterior-superior\nspace directions: none (" + step + ",0,0) (0," + step + ",0) (0,0," + step +
         ")\nspace origin: (0,0,0)\nkinds: 3D-symmetric-matrix space space space\n"
         "endian: little\nencoding: raw\n\n";
}

}  // namespace

int main(int argc, char** argv) {
  return surfcast::bench::run_cube_program<Tensor>("make_tensors", {argv, static_cast<size_t>(argc)},
                                                   {&header_of, &sample_at});
}
