#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <ostream>

namespace surfcast::reference {

/// A picture of an analytic field, 128 x 128 pixels, and its least accuracy against the ideal picture.
struct VolumeGoal {
  const char* name;
  const char* field;
  const char* view;
  glm::ivec3 size;     ///< samples
  double rays = 0;     ///< dB, drawn on the device
  double kernels = 0;  ///< dB, drawn by slabs of kernels in double precision
  double closer = 1;
};

inline constexpr int kGoalSide = 128;  ///< pixels
inline constexpr std::array kVolumeGoals{
    VolumeGoal{"torus_mid", "torus", "mid", glm::ivec3(32), 48, 51.5},
    VolumeGoal{"torus_closer", "torus", "mid", glm::ivec3(32), 48, 51, 1.1},
    VolumeGoal{"torus_farther", "torus", "mid", glm::ivec3(32), 48, 51, 0.9},
    VolumeGoal{"ball_mid", "ball", "mid", glm::ivec3(32), 36, 37},
    VolumeGoal{"ball_closer", "ball", "mid", glm::ivec3(32), 36, 36.5, 1.1},
    VolumeGoal{"ball_farther", "ball", "mid", glm::ivec3(32), 36, 36.5, 0.9},
    VolumeGoal{"blobs_mid", "blobs", "mid", glm::ivec3(32), 52, 55},
    VolumeGoal{"blobs_closer", "blobs", "mid", glm::ivec3(32), 52, 54.5, 1.1},
    VolumeGoal{"blobs_farther", "blobs", "mid", glm::ivec3(32), 52, 54.5, 0.9},
    VolumeGoal{"ml_mid", "ml", "mid", glm::ivec3(41), 36.5, 37.5},
    VolumeGoal{"ml_closer", "ml", "mid", glm::ivec3(41), 36.5, 36.5, 1.1},
    VolumeGoal{"ml_farther", "ml", "mid", glm::ivec3(41), 36.5, 36.5, 0.9},
    VolumeGoal{"torus_low", "torus", "low", glm::ivec3(32), 47, 50.5},
    VolumeGoal{"torus_wide", "torus", "wide", glm::ivec3(32), 48, 49.5},
    VolumeGoal{"torus_near", "torus", "near", glm::ivec3(32), 45.5, 50},
    VolumeGoal{"torus_inside", "torus", "inside", glm::ivec3(32), 36.5, 50},
    VolumeGoal{"torus_anisotropic", "torus", "mid", glm::ivec3(32, 32, 16), 38.5, 39.5},
    VolumeGoal{"torus_far", "torus", "far", glm::ivec3(64), 36, 36},
};

inline std::ostream& operator<<(std::ostream& out, const VolumeGoal& goal) {
  return out << goal.field << ' ' << goal.view << ' ' << goal.rays << " dB, " << goal.kernels << " dB";
}

}  // namespace surfcast::reference
