#include "model/volume_facts.h"

#include <array>
#include <glm/geometric.hpp>

namespace surfcast::model {

const char* type_name(uint8_t type) {
  constexpr std::array kTypes{"uint8", "int8",   "uint16", "int16",   "uint32",
                              "int32", "uint64", "int64",  "float32", "float64"};
  return kTypes.at(type);
}

const char* frame_name(const Volume& volume) {
  constexpr std::array<const char*, kWorldFrames> kFrames{"", "RAS", "LAS", "LPS"};
  return kFrames.at(static_cast<size_t>(volume.frame));
}

glm::dvec3 spacing_of(const Volume& volume) {
  const glm::dmat4x3& axes = volume.index_to_world;
  return {glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])};
}

}  // namespace surfcast::model
