#include "warp/warp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

namespace surfcast::warp {
namespace {

// The frame at rest is shown where its inverse depth is that of the newest frame to this part of the larger one.
constexpr float kAgreement = 0.05F;
// What continues a surface lies behind what the frame shows of it, and what fills holes lies behind its slopes, too.
constexpr float kContinued = 0.999F;
constexpr float kFilled = 0.9F;
// Pixels beside an outline that differ by less than this from what is behind it, squared and summed over the channels,
// belong to that. JPEG changes them by 2 to 4 levels.
constexpr int kSameColor = 48;
constexpr double kOnEdge = 1e-9;  // barycentric

/// A vertex in the target: pixel times w, and w, where w is depth relative to the frame's; of background to any.
struct Projected {
  glm::dvec3 place{0};
  glm::dvec2 pixel{0};  ///< of the frame
  double inverse = 0;   ///< in the frame
  double front = 0;     ///< as in MeshVertex
};

/// Takes points of a frame to a target.
class Projection {
 public:
  Projection(const geometry::CameraFrame& from, const geometry::CameraFrame& to)
      : from_(from), to_(to), moved_(to.rotate(from.eye - to.eye)) {
    const auto turned = [&](const glm::dvec3& axis) { return to.rotate(axis); };
    turn_ = glm::dmat3(turned(from.right), turned(from.up), turned(from.forward));
  }

  [[nodiscard]] Projected operator()(const MeshVertex& vertex) const {
    const glm::dvec3 ray = from_.ray(vertex.pixel);
    const glm::dvec3 v = turn_ * ray + double{vertex.inverse} * moved_;
    return {{to_.eta * v.x + 0.5 * to_.width * v.z, 0.5 * to_.height * v.z - to_.eta * v.y, v.z},
            glm::dvec2(vertex.pixel),
            vertex.inverse,
            vertex.front};
  }

 private:
  geometry::CameraFrame from_;
  geometry::CameraFrame to_;
  glm::dvec3 moved_;  ///< eye of the frame as the target sees it
  glm::dmat3 turn_{1};
};

/// What is seen in each pixel of the target so far.
struct Target {
  explicit Target(const geometry::CameraFrame& camera)
      : width(camera.width),
        height(camera.height),
        inverse(static_cast<size_t>(width) * static_cast<size_t>(height), -1.0F),
        density(inverse.size(), 0.0F) {}

  int width;
  int height;
  std::vector<float> inverse;  ///< 1 / depth; -1: nothing
  std::vector<float> density;  ///< pixels of the frame in a pixel, along one direction; -1: made up
};

/// The colour at a place of a picture, by its four nearest pixels.
std::array<uint8_t, 3> sample(const Pixels& from, double x, double y) {
  const double column = std::clamp(x - 0.5, 0.0, from.width - 1.0);
  const double row = std::clamp(y - 0.5, 0.0, from.height - 1.0);
  const auto left = static_cast<int>(column);
  const auto top = static_cast<int>(row);
  const int right = std::min(left + 1, from.width - 1);
  const int bottom = std::min(top + 1, from.height - 1);
  const auto fx = static_cast<float>(column - left);
  const auto fy = static_cast<float>(row - top);
  const auto pixel = [&](int px, int py) {
    return &from.rgb[3 * (static_cast<size_t>(py) * static_cast<size_t>(from.width) + static_cast<size_t>(px))];
  };
  const uint8_t* a = pixel(left, top);
  const uint8_t* b = pixel(right, top);
  const uint8_t* c = pixel(left, bottom);
  const uint8_t* d = pixel(right, bottom);
  std::array<uint8_t, 3> color{};
  for (size_t i = 0; i < 3; ++i) {
    const float upper = std::lerp(static_cast<float>(a[i]), static_cast<float>(b[i]), fx);
    const float lower = std::lerp(static_cast<float>(c[i]), static_cast<float>(d[i]), fx);
    color.at(i) = static_cast<uint8_t>(std::lerp(upper, lower, fy) + 0.5F);
  }
  return color;
}

/// A triangle in the target. Values that are affine on the surface, divided by w, are affine on the screen.
class Triangle {
 public:
  Triangle(const Projected& a, const Projected& b, const Projected& c) : corners_{&a, &b, &c} {
    if (std::min({a.place.z, b.place.z, c.place.z}) <= 0) return;  // behind the eye
    for (size_t i = 0; i < 3; ++i) screen_.at(i) = glm::dvec2(corners_.at(i)->place) / corners_.at(i)->place.z;
    area_ = cross(screen_[1] - screen_[0], screen_[2] - screen_[0]);
  }

  [[nodiscard]] bool visible() const { return area_ != 0; }

  /// Pixels of the frame in a pixel of the target, along one direction.
  [[nodiscard]] float density() const {
    const double source = cross(corners_[1]->pixel - corners_[0]->pixel, corners_[2]->pixel - corners_[0]->pixel);
    return static_cast<float>(std::sqrt(std::abs(source / area_)));
  }

  /// The least inverse depth of a corner, in the target.
  [[nodiscard]] double farthest() const {
    double least = corners_[0]->inverse / corners_[0]->place.z;
    for (const Projected* corner : corners_) least = std::min(least, corner->inverse / corner->place.z);
    return least;
  }

  /// Calls `draw(x, y, pixel of the frame, inverse depth in the target)` for each pixel whose centre is inside.
  template <typename Draw>
  void for_each_pixel(int width, int height, const Draw& draw) const {
    const auto [left, right] = std::minmax({screen_[0].x, screen_[1].x, screen_[2].x});
    const auto [top, bottom] = std::minmax({screen_[0].y, screen_[1].y, screen_[2].y});
    const int x0 = first_centre(left, width);
    const int x1 = first_centre(right, width);
    const int y1 = first_centre(bottom, height);
    for (int y = first_centre(top, height); y < y1; ++y) {
      for (int x = x0; x < x1; ++x) draw_if_inside({x + 0.5, y + 0.5}, x, y, draw);
    }
  }

 private:
  static double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

  /// The first pixel whose centre is not before this place.
  static int first_centre(double place, int pixels) {
    return static_cast<int>(std::clamp(std::ceil(place - 0.5), 0.0, static_cast<double>(pixels)));
  }

  /// A centre on an edge belongs to both triangles, whatever the rounding: the nearer one wins.
  template <typename Draw>
  void draw_if_inside(const glm::dvec2& centre, int x, int y, const Draw& draw) const {
    std::array<double, 3> part{};
    for (size_t i = 0; i < 3; ++i) {
      const glm::dvec2& from = screen_.at((i + 1) % 3);
      part.at(i) = cross(screen_.at((i + 2) % 3) - from, centre - from) / area_;
      if (part.at(i) < -kOnEdge) return;
    }
    double w = 0;  // 1 / depth relative to the frame's
    double inverse = 0;
    glm::dvec2 pixel(0);
    double front = 0;
    for (size_t i = 0; i < 3; ++i) {
      const Projected& corner = *corners_.at(i);
      const double share = part.at(i) / corner.place.z;
      w += share;
      inverse += share * corner.inverse;
      pixel += share * corner.pixel;
      front += share * corner.front;
    }
    draw(x, y, pixel / w, static_cast<float>(inverse), front / w);
  }

  std::array<const Projected*, 3> corners_;
  std::array<glm::dvec2, 3> screen_{};
  double area_ = 0;  ///< twice, signed
};

void put(Pixels& picture, size_t at, const std::array<uint8_t, 3>& color) {
  std::ranges::copy(color, picture.rgb.begin() + static_cast<ptrdiff_t>(3 * at));
}

int distance(const std::array<uint8_t, 3>& a, const std::array<uint8_t, 3>& b) {
  int sum = 0;
  for (size_t i = 0; i < 3; ++i) sum += (a.at(i) - b.at(i)) * (a.at(i) - b.at(i));
  return sum;
}

/// A pixel of a sheet: its colour, and whether the frame shows it there.
struct Shown {
  std::array<uint8_t, 3> color{};
  bool own = true;
};

Shown shown(const WarpFrame& frame, const MeshTriangle& mesh, const glm::dvec2& pixel, double front) {
  if (mesh.sheet == Sheet::kFill) return {sample(frame.pixels, mesh.far.x, mesh.far.y), false};
  const std::array<uint8_t, 3> color = sample(frame.pixels, pixel.x, pixel.y);
  if (mesh.sheet == Sheet::kSurface) return {color, true};
  const std::array<uint8_t, 3> far = sample(frame.pixels, mesh.far.x, mesh.far.y);
  const bool in_front = front >= 0.5 && distance(color, far) >= kSameColor;
  if (mesh.sheet == Sheet::kNear) return {color, in_front};
  return in_front ? Shown{far, false} : Shown{color, true};
}

/// A place of a frame in the target.
struct Place {
  size_t at = 0;  ///< pixel of the target
  glm::dvec2 pixel{0};
  float inverse = 0;  ///< in the target
  double front = 0;
  float density = 0;
};

/// Calls `draw(triangle of the mesh, place, farthest inverse depth)` for each pixel of the target that a triangle
/// covers.
template <typename Draw>
void for_each_place(const WarpFrame& frame, const geometry::CameraFrame& camera, const Draw& draw) {
  const Projection projection(frame.camera, camera);
  for (const MeshTriangle& mesh : frame.mesh) {
    const Projected a = projection(mesh.corners[0]);
    const Projected b = projection(mesh.corners[1]);
    const Projected c = projection(mesh.corners[2]);
    const Triangle triangle(a, b, c);
    if (!triangle.visible()) continue;
    const auto farthest = static_cast<float>(triangle.farthest());
    const float density = triangle.density();
    triangle.for_each_pixel(
        camera.width, camera.height, [&](int x, int y, const glm::dvec2& pixel, float inverse, double front) {
          const auto at = static_cast<size_t>(y) * static_cast<size_t>(camera.width) + static_cast<size_t>(x);
          draw(mesh, Place{at, pixel, inverse, front, density}, farthest);
        });
  }
}

/// Draws a frame, with what fills its holes.
void draw_newest(const WarpFrame& frame, const geometry::CameraFrame& camera, Target& target, Pixels& picture) {
  for_each_place(frame, camera, [&](const MeshTriangle& mesh, const Place& place, float farthest) {
    float inverse = mesh.sheet == Sheet::kFill ? farthest * kFilled : place.inverse;
    if (inverse <= target.inverse[place.at]) return;
    const Shown drawn = shown(frame, mesh, place.pixel, place.front);
    if (mesh.sheet == Sheet::kNear && !drawn.own) return;
    if (mesh.sheet == Sheet::kFar && !drawn.own) inverse *= kContinued;
    if (inverse <= target.inverse[place.at]) return;
    target.inverse[place.at] = inverse;
    target.density[place.at] = drawn.own ? place.density : -1;
    put(picture, place.at, drawn.color);
  });
}

/// Draws what a former frame shows, where the newest one shows nothing, or the same not as sharp.
void draw_rest(const WarpFrame& frame, const geometry::CameraFrame& camera, const Target& newest, Pixels& picture) {
  Target target(camera);
  for_each_place(frame, camera, [&](const MeshTriangle& mesh, const Place& place, float) {
    if (mesh.sheet == Sheet::kFill || mesh.background || place.inverse <= target.inverse[place.at]) return;
    const Shown drawn = shown(frame, mesh, place.pixel, place.front);
    if (!drawn.own) return;
    target.inverse[place.at] = place.inverse;
    const float there = newest.inverse[place.at];
    const bool nothing = there < 0 || newest.density[place.at] < 0;
    const bool agrees = std::abs(place.inverse - there) <= kAgreement * std::max(place.inverse, there);
    const bool sharper = place.density >= newest.density[place.at];
    if (nothing || (agrees && sharper)) put(picture, place.at, drawn.color);
  });
}

}  // namespace

Pixels warp(const WarpFrame& newest, const WarpFrame* rest, const geometry::CameraFrame& target,
            const std::array<uint8_t, 3>& background) {
  Pixels picture{target.width, target.height, {}};
  picture.rgb.resize(3 * static_cast<size_t>(target.width) * static_cast<size_t>(target.height));
  for (size_t at = 0; at < picture.rgb.size() / 3; ++at) put(picture, at, background);
  Target seen(target);
  draw_newest(newest, target, seen, picture);
  if (rest != nullptr) draw_rest(*rest, target, seen, picture);
  return picture;
}

}  // namespace surfcast::warp
