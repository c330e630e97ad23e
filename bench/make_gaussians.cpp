// make_gaussians COUNT FILE.ply: writes a generated model of COUNT 3D Gaussians without harmonics, as training programs
// do: flat, mostly opaque ones on a hilly ground of side 100, in no order.

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/atomic_file.h"

namespace {

using surfcast::AtomicFile;
using surfcast::Status;

constexpr uint64_t kRows = 65536;  // written at once
static_assert(std::endian::native == std::endian::little);

/// x y z, three colours, opacity, three scales, w x y z.
using Row = std::array<float, 14>;

/// Numbers that look random (the finaliser of splitmix64).
class Numbers {
 public:
  explicit Numbers(uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15U) {}

  double between(double low, double high) {
    uint64_t z = state_ += 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return low + (high - low) * static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

 private:
  uint64_t state_;
};

/// Height of the ground, downwards, and its slopes along x and z.
std::array<double, 3> ground(double x, double z) {
  return {-3 * std::sin(0.2 * x) * std::cos(0.15 * z) - 0.3 * std::sin(1.7 * x + z),
          -0.6 * std::cos(0.2 * x) * std::cos(0.15 * z) - 0.51 * std::cos(1.7 * x + z),
          0.45 * std::sin(0.2 * x) * std::sin(0.15 * z) - 0.3 * std::cos(1.7 * x + z)};
}

/// `size`: logarithm of the distance between neighbours.
Row row_of(uint64_t i, double size) {
  Numbers numbers(i);
  const double x = numbers.between(-50, 50);
  const double z = numbers.between(-50, 50);
  const auto [y, along_x, along_z] = ground(x, z);
  // The rotation takes y, the shortest axis, to the normal (-along_x, 1, -along_z).
  const double length = std::sqrt(1 + along_x * along_x + along_z * along_z);
  const double shade = 0.5 + 0.3 * along_x + numbers.between(-0.2, 0.2);
  const std::array<double, 14> values{x,
                                      y + numbers.between(-0.02, 0.02),
                                      z,
                                      shade,
                                      1.5 * shade,
                                      0.5 * shade,
                                      numbers.between(-1, 5),
                                      size + numbers.between(-0.8, 0.3),
                                      size + numbers.between(-4, -2),
                                      size + numbers.between(-0.8, 0.3),
                                      length + 1,
                                      -along_z,
                                      0,
                                      along_x};
  Row row{};
  for (size_t k = 0; k < row.size(); ++k) row.at(k) = static_cast<float>(values.at(k));
  return row;
}

std::string header_of(uint64_t count) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(count) + "\n";
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
                           "rot_0", "rot_1", "rot_2", "rot_3"}) {
    text += "property float " + std::string(name) + "\n";
  }
  return text + "end_header\n";
}

Status write_model(uint64_t count, const char* path) {
  surfcast::Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return surfcast::fail(file);
  const std::string header = header_of(count);
  if (Status status = file->append(std::as_bytes(std::span(header))); !status) return status;
  const double size = std::log(100 / std::sqrt(static_cast<double>(count)));
  for (uint64_t first = 0; first < count; first += kRows) {
    std::vector<Row> rows;
    for (uint64_t i = first; i < std::min(count, first + kRows); ++i) rows.push_back(row_of(i, size));
    if (Status status = file->append(std::as_bytes(std::span(rows))); !status) return status;
  }
  return file->commit();
}

}  // namespace

int main(int argc, char** argv) {
  uint64_t count = 0;
  const std::string_view number = argc == 3 ? argv[1] : "";
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), count);
  if (number.empty() || error != std::errc() || end != number.data() + number.size() || count == 0) {
    std::cerr << "usage: make_gaussians COUNT FILE.ply\n";
    return 2;
  }
  const Status status = write_model(count, argv[2]);
  if (!status) std::cerr << "make_gaussians: " << status.error().message << "\n";
  return status ? 0 : 1;
}
