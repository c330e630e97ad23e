#include "lab/scan_points.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/common.hpp>
#include <numeric>
#include <tuple>

#include "scan/scan_stream.h"

namespace surfcast::lab {
namespace {

bool finite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// Appends the columns that every piece has.
void append(const scan::ScanPoints& piece, LabPoints& points) {
  points.positions.insert(points.positions.end(), piece.positions.begin(), piece.positions.end());
  points.normals.insert(points.normals.end(), piece.normals.begin(), piece.normals.end());
  if (piece.colors) {
    const int step = piece.colors->bits == 8 ? 1 : 257;
    for (const glm::u16vec3& c : piece.colors->values) points.colors.emplace_back((glm::ivec3(c) + step / 2) / step);
  }
  for (const surfel::ScalarAttribute& scalar : piece.scalars) {
    if (scalar.name != "intensity") continue;
    std::visit(
        [&](const auto& values) {
          for (const auto v : values) points.intensities.push_back(static_cast<float>(v));
        },
        scalar.values);
  }
}

/// Whether a point is usable and the first at its position.
std::vector<bool> distinct(const std::vector<glm::dvec3>& positions) {
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < positions.size(); ++i) {
    if (finite(positions[i])) order.push_back(i);
  }
  const auto key = [&](uint32_t i) { return std::tie(positions[i].x, positions[i].y, positions[i].z); };
  std::ranges::stable_sort(order, [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
  std::vector<bool> keep(positions.size(), false);
  for (size_t k = 0; k < order.size(); ++k) {
    keep[order[k]] = k == 0 || positions[order[k - 1]] != positions[order[k]];
  }
  return keep;
}

template <typename T>
std::vector<T> kept(const std::vector<T>& values, const std::vector<bool>& keep) {
  std::vector<T> result;
  for (size_t i = 0; i < values.size(); ++i) {
    if (keep[i]) result.push_back(values[i]);
  }
  return result;
}

template <typename T>
void write_value(std::ofstream& file, const T& value) {
  file.write(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

Result<LabPoints> read_points(const std::filesystem::path& path) {
  const Result<scan::ScanStream> stream = scan::ScanStream::open(path);
  if (!stream) return fail(stream);
  LabPoints points;
  points.z_up = stream->schema().z_up;
  for (size_t piece = 0; piece < stream->pieces(); ++piece) {
    const Result<scan::ScanPoints> read = stream->read(piece);
    if (!read) return fail(read);
    append(*read, points);
  }
  return kept_points(points, distinct(points.positions));
}

LabPoints kept_points(const LabPoints& points, const std::vector<bool>& keep) {
  return {kept(points.positions, keep), kept(points.colors, keep), kept(points.intensities, keep),
          kept(points.normals, keep), points.z_up};
}

bool write_ply(const LabPoints& points, const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size()
       << "\nproperty double x\nproperty double y\nproperty double z\n";
  if (!points.normals.empty()) file << "property float nx\nproperty float ny\nproperty float nz\n";
  if (!points.colors.empty()) file << "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (!points.intensities.empty()) file << "property float intensity\n";
  file << "end_header\n";
  for (size_t i = 0; i < points.size(); ++i) {
    write_value(file, points.positions[i]);
    if (!points.normals.empty()) write_value(file, points.normals[i]);
    if (!points.colors.empty()) write_value(file, points.colors[i]);
    if (!points.intensities.empty()) write_value(file, points.intensities[i]);
  }
  return static_cast<bool>(file.flush());
}

std::vector<glm::u8vec3> intensity_levels(const std::vector<float>& intensities) {
  std::vector<float> sorted = intensities;
  std::erase_if(sorted, [](float v) { return !std::isfinite(v); });
  if (sorted.empty()) return {};
  std::ranges::sort(sorted);
  const auto at = [&](double share) {
    return sorted[static_cast<size_t>(share * static_cast<double>(sorted.size() - 1))];
  };
  const float low = at(0.02);
  const float high = at(0.98);
  if (!(low < high)) return {};
  std::vector<glm::u8vec3> levels;
  for (const float v : intensities) {
    const double share = std::isfinite(v) ? std::clamp((double{v} - low) / (double{high} - low), 0.0, 1.0) : 0.0;
    levels.emplace_back(static_cast<int>(std::lround(255 * share)));
  }
  return levels;
}

}  // namespace surfcast::lab
