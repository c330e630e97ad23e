// make_grid SIDE FILE.nrrd: writes a generated grid of SIDE^3 unsigned 16 bit samples over a cube of side 1.
//
// The field is the same for any number of samples: nested wavy shells of different densities, as of a body with bones
// and vessels, and noise of 8 steps from sample to sample. Planes are streamed, so that a grid may be larger than
// memory.

#include <cmath>
#include <cstdint>
#include <string>

#include "write_cube.h"

namespace {

/// A number from 0 to 15 that looks random (the finaliser of splitmix64).
uint64_t noise(uint64_t sample) {
  uint64_t z = sample * 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return (z ^ (z >> 31)) & 15U;
}

/// Rises from 0 to 1 around x = 0, over about `width`.
double edge(double x, double width) {
  return 1 / (1 + std::exp(-4 * x / width));
}

/// The density at a place in the unit cube, 0 to 4000.
double density(double x, double y, double z) {
  const double u = 2 * x - 1;
  const double v = 2 * y - 1;
  const double w = 2 * z - 1;
  const double r = std::sqrt(u * u + 1.4 * v * v + 0.8 * w * w) + 0.03 * std::sin(9 * u + 4 * w) * std::cos(7 * v);
  const double skin = edge(0.85 - r, 0.01);
  const double bone = edge(0.7 - r, 0.01) * edge(r - 0.62, 0.01);
  const double vessels =
      edge(std::sin(25 * u + 6 * v) * std::sin(21 * v - 5 * w) * std::sin(23 * w + 4 * u) - 0.6, 0.1);
  return 900 * skin + 2100 * bone + 700 * vessels * edge(0.6 - r, 0.02);
}

uint16_t sample_at(uint64_t i, uint64_t j, uint64_t k, uint64_t side) {
  const auto place = [side](uint64_t n) { return (static_cast<double>(n) + 0.5) / static_cast<double>(side); };
  const double value = density(place(i), place(j), place(k));
  return static_cast<uint16_t>(std::lround(value) + noise((k * side + j) * side + i));
}

std::string header_of(uint64_t side) {
  const std::string count = std::to_string(side);
  const std::string step = std::to_string(1 / static_cast<double>(side));
  return "NRRD0004\ntype: uint16\ndimension: 3\nsizes: " + count + " " + count + " " + count + "\nspacings: " + step +
         " " + step + " " + step + "\nendian: little\nencoding: raw\n\n";
}

}  // namespace

int main(int argc, char** argv) {
  return surfcast::bench::run_cube_program<uint16_t>("make_grid", {argv, static_cast<size_t>(argc)},
                                                     {&header_of, &sample_at});
}
