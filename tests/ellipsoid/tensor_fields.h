#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <string>

#include "ellipsoid/tensor.h"
#include "scan/bytes.h"

namespace surfcast::testing {

/// The tensors of a made field: needles that turn about the z axis with the height, (0.004, 0.002, 0.001), with a
/// confidence of 0 outside of a ball.
inline ellipsoid::SymmetricTensor made_tensor(const glm::dvec3& unit_place) {
  const double angle = 3 * unit_place.z;
  const glm::dvec3 needle(std::cos(angle), std::sin(angle), 0);
  const glm::dmat3 axes(needle, {0, 0, 1}, glm::cross(needle, {0, 0, 1}));
  return ellipsoid::tensor_of({0.004, 0.002, 0.001}, axes);
}

/// An NRRD file of side^3 masked tensors, steps of 2 from the origin. One of the tensors within the ball is negative.
inline std::filesystem::path write_tensor_field(const std::filesystem::path& path, int side) {
  const std::string sides = std::to_string(side);
  Bytes bytes("NRRD0005\ntype: float\ndimension: 4\nsizes: 7 " + sides + " " + sides + " " + sides +
              "\nspace: right-anterior-superior\nspace directions: none (2,0,0) (0,2,0) (0,0,2)\n"
              "space origin: (0,0,0)\nkinds: 3D-masked-symmetric-matrix space space space\nencoding: raw\n"
              "endian: little\n\n");
  for (int i = 0; i < side * side * side; ++i) {
    const glm::dvec3 index(i % side, i / side % side, i / side / side);
    const glm::dvec3 place = 2.0 * index / (side - 1.0) - 1.0;
    const ellipsoid::SymmetricTensor t = made_tensor(place);
    const double sign = index == glm::dvec3(side / 2) ? -1 : 1;
    bytes.add(glm::length(place) <= 1 ? 1.0F : 0.0F);
    for (const double entry : {t.xx, t.xy, t.xz, t.yy, t.yz, t.zz}) bytes.add(static_cast<float>(sign * entry));
  }
  std::ofstream(path, std::ios::binary) << bytes.text();
  return path;
}

}  // namespace surfcast::testing
