#include "reference/volume_field.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>

namespace surfcast::reference {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFadeRadius = 0.97;
constexpr double kFadeWidth = 0.012;
constexpr double kBallRadius = 0.7;
constexpr double kBallEdge = 0.02;
constexpr double kTorusRadius = 0.6;
constexpr double kTubeDeviation = 0.125;
constexpr int kTorusWaves = 5;
constexpr double kDifference = 1e-4;

/// From 1 within the radius to 0 outside.
double logistic_edge(double r, double radius, double width) {
  return 1 / (1 + std::exp((r - radius) / width));
}

struct Blob {
  glm::dvec3 centre;
  double deviation;
  double height;
};

constexpr Blob kBlobs[] = {{{-0.35, 0.3, 0.1}, 0.17, 1.0},   {{0.4, 0.25, -0.2}, 0.145, 0.9},
                           {{0.05, -0.4, 0.3}, 0.187, 0.8},  {{-0.3, -0.3, -0.4}, 0.128, 1.0},
                           {{0.35, -0.15, 0.35}, 0.11, 0.7}, {{0.0, 0.2, -0.45}, 0.153, 0.85}};

}  // namespace

double marschner_lobb_signal(const glm::dvec3& p) {
  constexpr double kAlpha = 0.25;
  constexpr double kFrequency = 6;
  const double r = glm::length(glm::dvec2(p));
  const double ring = std::cos(2 * kPi * kFrequency * std::cos(0.5 * kPi * r));
  return (1 - std::sin(0.5 * kPi * p.z) + kAlpha * (1 + ring)) / (2 * (1 + kAlpha));
}

VolumeField marschner_lobb() {
  return {"ml", [](const glm::dvec3& p) {
            return marschner_lobb_signal(p) * logistic_edge(glm::length(p), kFadeRadius, kFadeWidth);
          }};
}

VolumeField ball_field() {
  return {"ball", [](const glm::dvec3& p) { return logistic_edge(glm::length(p), kBallRadius, kBallEdge); }};
}

VolumeField torus_field() {
  return {"torus", [](const glm::dvec3& p) {
            const double from_circle =
                glm::length(glm::dvec2(glm::length(glm::dvec2(p)) - kTorusRadius, p.z)) / kTubeDeviation;
            const double wave = 0.8 + 0.2 * std::cos(kTorusWaves * std::atan2(p.y, p.x));
            return wave * std::exp(-0.5 * from_circle * from_circle);
          }};
}

VolumeField blobs_field() {
  return {"blobs", [](const glm::dvec3& p) {
            double sum = 0;
            for (const Blob& blob : kBlobs) {
              const glm::dvec3 d = (p - blob.centre) / blob.deviation;
              sum += blob.height * std::exp(-0.5 * glm::dot(d, d));
            }
            return sum;
          }};
}

glm::dvec3 gradient(const VolumeField& field, const glm::dvec3& p) {
  glm::dvec3 result;
  for (int i = 0; i < 3; ++i) {
    glm::dvec3 step{0};
    step[i] = kDifference;
    result[i] = (field.value(p + step) - field.value(p - step)) / (2 * kDifference);
  }
  return result;
}

}  // namespace surfcast::reference
