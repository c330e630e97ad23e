#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

namespace surfcast::lab {

/// True for one point in five, by a hash of its coordinates. The choice depends neither on the order of the points nor
/// on what else is in the scan.
bool left_out(const glm::dvec3& position);

/// The depths of a picture. Rows run from top to bottom.
struct DepthPicture {
  int width = 0;
  int height = 0;
  std::vector<float> depths;  ///< distance along the view axis, world units; infinite where there is background

  DepthPicture(int w, int h);
  [[nodiscard]] size_t index(int x, int y) const { return static_cast<size_t>(y) * width + x; }
};

enum class Verdict { kSeen, kHidden, kMissing };

/// Compares a point at the pixel position `pixel` and the depth `z` with the 3 x 3 pixels around it. It is hidden if at
/// least seven of them are nearer by more than `tolerance` (world units), and missing if at least seven are farther by
/// that or background. A slope has nearer pixels on one side and farther ones on the other, and never seven of its own
/// plane. None if the nine pixels are not all in the picture.
std::optional<Verdict> judge(const DepthPicture& picture, const glm::dvec2& pixel, double z, double tolerance);

/// Two spacings of the point's neighbourhood and the footprint of a pixel. `eta` is CameraFrame::eta.
double depth_tolerance(double spacing, double z, double eta);

/// Counts of points that were left out, over all cameras. A point counts once for each camera to which it is open.
struct LeaveOutCounts {
  std::array<uint64_t, 3> by_verdict{};
  uint64_t off_surface = 0;     ///< open points that the witness finds on no surface
  uint64_t surface_hidden = 0;  ///< hidden points among those on a surface

  void count(Verdict verdict, bool surface);
  void add(const LeaveOutCounts& other);
  [[nodiscard]] uint64_t open() const { return by_verdict[0] + by_verdict[1] + by_verdict[2]; }
  [[nodiscard]] double percent(Verdict verdict) const;
  [[nodiscard]] double off_surface_percent() const;
  [[nodiscard]] double surface_hidden_percent() const;
};

/// Difference between the colours of points and of the pixels that show them.
struct ColorErrors {
  uint64_t points = 0;
  double squares = 0;  ///< levels of 255, summed over points and channels

  void add(const glm::u8vec3& pixel, const glm::u8vec3& point);
  void add(const ColorErrors& other);
  /// Root mean square over channels and points, levels of 255. None without points.
  [[nodiscard]] std::optional<double> rms() const;
};

}  // namespace surfcast::lab
