#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "kinds/ball_kind.h"
#include "kinds/kind_table.h"

namespace surfcast::testing {

/// The table of kinds with surfels and balls.
kinds::KindTable kinds_with_balls();

/// A square of surfels in the plane z = 0, from -1.5 to 1.5, and balls in front of it, behind it and through it.
struct BallScene {
  static constexpr double kSide = 3;
  static constexpr int kSurfelsAcross = 150;
  static constexpr glm::u8vec3 kSquareColor{60, 120, 180};

  std::array<Ball, 4> balls{
      {{{-0.75, 0.5, 0.75}, 0.375F, {250, 40, 10}},
       {{0.75, 0.5, -0.75}, 0.5F, {10, 240, 30}},
       {{0.5, -0.75, 0}, 0.5F, {250, 220, 20}},
       {{1.5, 0.5, -0.5}, 0.5F, {230, 30, 230}}}};       ///< the last one is half behind the square's edge
  Ball coarse{{0.25, 0, 0.25}, 1.25F, {128, 128, 128}};  ///< the coarse version of all of them
};

/// Writes the scene as a model file: the square as `write_model` writes it, and two leaves of balls under a coarse
/// block.
std::filesystem::path write_scene(const std::filesystem::path& target, const BallScene& scene = {},
                                  int surfels_across = BallScene::kSurfelsAcross);
/// Writes only the balls of the scene.
std::filesystem::path write_balls(const std::filesystem::path& target, const BallScene& scene = {});

}  // namespace surfcast::testing
