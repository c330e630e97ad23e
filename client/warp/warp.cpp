#include "warp/warp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <optional>
#include <thread>
#include <utility>

#include "warp/fill_colors.h"

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
// Where things are seen through, the frame at rest is shown where its colour does not differ by more: another depth may
// shine through there. Frames in motion are less sharp, so that opaque ones differ everywhere.
constexpr int kSameLook = 6000;
// The cosine of the largest angle between the rays of two eyes at which the frame at rest covers the newest one. Depths
// are coarse, so that a surface is displaced once the eye has moved farther around it.
constexpr double kLeastCosine = 0.906;  // 25 degrees
constexpr double kOnEdge = 1e-9;        // barycentric
constexpr int kMaxBands = 16;

/// A vertex in the target: pixel times w, and w, where w is depth relative to the frame's; of background to any.
struct Projected {
  glm::dvec3 place{0};
  glm::dvec2 pixel{0};  ///< of the frame
  double inverse = 0;   ///< in the frame
  double front = 0;     ///< as in MeshVertex
  double cosine = 1;    ///< of the angle between the rays to it from the eyes of the frame and the target
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
    const glm::dvec3 turned = turn_ * ray;
    const glm::dvec3 v = turned + double{vertex.inverse} * moved_;
    const double cosine = glm::dot(v, turned) / (glm::length(v) * glm::length(ray));
    return {{to_.eta * v.x + 0.5 * to_.width * v.z, 0.5 * to_.height * v.z - to_.eta * v.y, v.z},
            glm::dvec2(vertex.pixel),
            vertex.inverse,
            vertex.front,
            cosine};
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
        inverse(static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height), -1.0F),
        density(inverse.size(), 0.0F) {}

  int width;
  std::vector<float> inverse;  ///< 1 / depth; -1: nothing
  std::vector<float> density;  ///< pixels of the frame in a pixel, along one direction; -1: made up
};

/// Between two colours, by 256ths. Two channels at a time, which keep out of each other's way.
Color mixed(Color a, Color b, uint32_t part) {
  constexpr uint32_t kEven = 0x00ff00ff;
  constexpr uint32_t kHalf = 0x00800080;
  const uint32_t even = ((a & kEven) * (256 - part) + (b & kEven) * part + kHalf) >> 8 & kEven;
  const uint32_t odd = (((a >> 8) & kEven) * (256 - part) + ((b >> 8) & kEven) * part + kHalf) & ~kEven;
  return even | odd;
}

/// The colour at a place of a picture, by its four nearest pixels.
Color sample(const Pixels& from, float x, float y) {
  // Half of a 256th more, so that parts are rounded.
  constexpr float kHalfPart = 1.0F / 512;
  const float column = std::clamp(x - 0.5F, 0.0F, static_cast<float>(from.width - 1)) + kHalfPart;
  const float row = std::clamp(y - 0.5F, 0.0F, static_cast<float>(from.height - 1)) + kHalfPart;
  const auto left = static_cast<int>(column);
  const auto top = static_cast<int>(row);
  const auto part_x = static_cast<uint32_t>((column - static_cast<float>(left)) * 256);
  const auto part_y = static_cast<uint32_t>((row - static_cast<float>(top)) * 256);
  const ptrdiff_t right = left + 1 < from.width ? 4 : 0;
  const ptrdiff_t below = top + 1 < from.height ? 4 * static_cast<ptrdiff_t>(from.width) : 0;
  const uint8_t* at = from.bytes.data() + 4 * (static_cast<ptrdiff_t>(top) * from.width + left);
  return mixed(mixed(color_at(at), color_at(at + right), part_x),
               mixed(color_at(at + below), color_at(at + below + right), part_x), part_y);
}

/// A value that is affine on the screen.
struct Plane {
  double constant = 0;
  double per_x = 0;
  double per_y = 0;

  [[nodiscard]] double at(double x, double y) const { return constant + per_x * x + per_y * y; }
  void add(const Plane& plane, double factor) {
    constant += factor * plane.constant;
    per_x += factor * plane.per_x;
    per_y += factor * plane.per_y;
  }
};

/// A triangle in the target. Values that are affine on the surface are affine on the screen, divided by w.
struct ScreenTriangle {
  const MeshTriangle* mesh = nullptr;
  std::array<Plane, 3> parts;  ///< barycentric coordinates
  Plane w;                     ///< 1 / w
  Plane inverse;               ///< 1 / depth in the target
  Plane pixel_x;               ///< of the frame
  Plane pixel_y;
  Plane front;
  std::array<Plane, 3> fill;  ///< channels of the fill colour
  int left = 0;               ///< pixels whose centres may be inside
  int right = 0;
  int top = 0;
  int bottom = 0;
  float farthest = 0;  ///< least inverse depth of a corner
  float density = 0;   ///< pixels of the frame in a pixel of the target, along one direction
  double cosine = 1;   ///< least one of a corner, see Projected
  Color far = 0;       ///< of what is behind, beside an outline
};

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// The first pixel whose centre is not before this place.
int first_centre(double place, int pixels) {
  return static_cast<int>(std::clamp(std::ceil(place - 0.5), 0.0, static_cast<double>(pixels)));
}

/// The barycentric coordinates of three places, of which that of the first one is 1 there.
Plane part_of(const glm::dvec2& one, const glm::dvec2& other, double area) {
  const glm::dvec2 along = other - one;
  return {(along.y * one.x - along.x * one.y) / area, -along.y / area, along.x / area};
}

/// None where it is not seen: behind the eye, from the side, or outside the picture.
std::optional<ScreenTriangle> screen_triangle(const MeshTriangle& mesh, const std::vector<Color>& fill_colors,
                                              const Projection& projection, int width, int height) {
  const std::array<Projected, 3> corners{projection(mesh.corners[0]), projection(mesh.corners[1]),
                                         projection(mesh.corners[2])};
  std::array<glm::dvec2, 3> screen;
  for (size_t i = 0; i < 3; ++i) {
    if (corners.at(i).place.z <= 0) return std::nullopt;
    screen.at(i) = glm::dvec2(corners.at(i).place) / corners.at(i).place.z;
  }
  const double area = cross(screen[1] - screen[0], screen[2] - screen[0]);
  if (area == 0 || !std::isfinite(area)) return std::nullopt;
  ScreenTriangle triangle;
  triangle.mesh = &mesh;
  const auto [left, right] = std::minmax({screen[0].x, screen[1].x, screen[2].x});
  const auto [top, bottom] = std::minmax({screen[0].y, screen[1].y, screen[2].y});
  triangle.left = first_centre(left, width);
  triangle.right = first_centre(right, width);
  triangle.top = first_centre(top, height);
  triangle.bottom = first_centre(bottom, height);
  if (triangle.left >= triangle.right || triangle.top >= triangle.bottom) return std::nullopt;
  const double source = cross(corners[1].pixel - corners[0].pixel, corners[2].pixel - corners[0].pixel);
  triangle.density = static_cast<float>(std::sqrt(std::abs(source / area)));
  double farthest = corners[0].inverse / corners[0].place.z;
  for (size_t i = 0; i < 3; ++i) {
    const Projected& corner = corners.at(i);
    const double share = 1 / corner.place.z;
    const Plane part = part_of(screen.at((i + 1) % 3), screen.at((i + 2) % 3), area);
    triangle.parts.at(i) = part;
    triangle.w.add(part, share);
    triangle.inverse.add(part, share * corner.inverse);
    triangle.pixel_x.add(part, share * corner.pixel.x);
    triangle.pixel_y.add(part, share * corner.pixel.y);
    triangle.front.add(part, share * corner.front);
    if (mesh.sheet != Sheet::kSurface && mesh.sheet != Sheet::kNear) {
      const Color color = fill_colors[mesh.corners.at(i).fill_texel];
      for (size_t c = 0; c < 3; ++c) triangle.fill.at(c).add(part, share * channel(color, static_cast<int>(c)));
    }
    farthest = std::min(farthest, share * corner.inverse);
    triangle.cosine = std::min(triangle.cosine, corner.cosine);
  }
  triangle.farthest = static_cast<float>(farthest);
  return triangle;
}

std::vector<ScreenTriangle> screen_triangles(const WarpFrame& frame, const geometry::CameraFrame& camera) {
  const Projection projection(frame.camera, camera);
  std::vector<ScreenTriangle> triangles;
  triangles.reserve(frame.mesh.size());
  for (const MeshTriangle& mesh : frame.mesh) {
    auto triangle = screen_triangle(mesh, frame.fill_colors, projection, camera.width, camera.height);
    if (!triangle) continue;
    if (mesh.sheet == Sheet::kNear || mesh.sheet == Sheet::kFar)
      triangle->far = sample(frame.pixels, mesh.far.x, mesh.far.y);
    triangles.push_back(*triangle);
  }
  return triangles;
}

void put(Pixels& picture, size_t at, Color color) {
  std::memcpy(picture.bytes.data() + 4 * at, &color, sizeof color);
}

/// Squared, of three channels.
int distance(Color a, Color b) {
  int sum = 0;
  for (const int i : {0, 1, 2}) {
    const int step = channel(a, i) - channel(b, i);
    sum += step * step;
  }
  return sum;
}

/// A pixel of a sheet: its colour, and whether the frame shows it there.
struct Shown {
  Color color = 0;
  bool own = true;
};

/// A place of a frame in the target.
struct Place {
  size_t at = 0;  ///< pixel of the target
  float x = 0;    ///< pixel of the frame
  float y = 0;
  float inverse = 0;  ///< in the target
  float front = 0;    ///< as in MeshVertex
  Color fill = 0;     ///< colour where the frame does not show this surface
};

/// Beyond the border of a frame: its reflection, which fades to the fill colour of the border.
Color surroundings(const Pixels& pixels, const Place& place) {
  const auto reflected = [](float at, int size) {
    return at < 0 ? -at : std::min(at, 2 * static_cast<float>(size) - at);
  };
  const Color reflection = sample(pixels, reflected(place.x, pixels.width), reflected(place.y, pixels.height));
  const float share = place.front > 0 ? std::min(place.front, 1.0F) : 0;  // also where it is NaN
  return mixed(place.fill, reflection, static_cast<uint32_t>(256 * share * share));
}

Shown shown(const Pixels& pixels, const ScreenTriangle& triangle, const Place& place) {
  const Sheet sheet = triangle.mesh->sheet;
  if (sheet == Sheet::kFill) return {place.fill, false};
  if (sheet == Sheet::kSurroundings) return {surroundings(pixels, place), false};
  const Color color = sample(pixels, place.x, place.y);
  if (sheet == Sheet::kSurface) return {color, true};
  const bool in_front = place.front >= 0.5F && distance(color, triangle.far) >= kSameColor;
  if (sheet == Sheet::kNear) return {color, in_front};
  return in_front ? Shown{place.fill, false} : Shown{color, true};
}

/// Rows of the target that are drawn together.
struct Band {
  int top = 0;
  int bottom = 0;
};

/// The columns of a row whose centres are inside a triangle. A centre on an edge belongs to both triangles, whatever
/// the rounding: the nearer one wins.
std::pair<int, int> columns_inside(const ScreenTriangle& triangle, double y) {
  double first = triangle.left + 0.5;
  double last = triangle.right - 0.5;
  for (const Plane& part : triangle.parts) {
    const double there = part.constant + part.per_y * y + kOnEdge;  // at least 0 where x = 0 is inside
    if (part.per_x > 0) first = std::max(first, -there / part.per_x);
    if (part.per_x < 0) last = std::min(last, -there / part.per_x);
    if (part.per_x == 0 && there < 0) return {0, 0};
  }
  // (A triangle that is seen nearly from the side has edges that meet a row anywhere.)
  first = std::min(first, triangle.right + 0.5);
  last = std::max(last, triangle.left - 0.5);
  return {static_cast<int>(std::ceil(first - 0.5)), static_cast<int>(std::floor(last - 0.5)) + 1};
}

/// The colour of three channels at a pixel.
Color color_of(const std::array<Plane, 3>& channels, double x, double y, double w) {
  Color color = 0;
  for (size_t i = 0; i < 3; ++i) {
    const double level = channels.at(i).at(x, y) / w;
    // (At extreme depths it may be NaN.)
    color |= static_cast<Color>(level > 0 ? std::lround(std::min(level, 255.0)) : 0) << (8 * i);
  }
  return color;
}

/// Calls `draw(place)` for each pixel of the band that the triangle covers, if it is nearer than what `inverse` has
/// there.
template <typename Draw>
void for_each_place(const ScreenTriangle& triangle, const Band& band, int width, const std::vector<float>& inverse,
                    const Draw& draw) {
  const Sheet sheet = triangle.mesh->sheet;
  const bool made_up = sheet == Sheet::kFill || sheet == Sheet::kSurroundings;
  const bool filled = made_up || sheet == Sheet::kFar;
  const int bottom = std::min(triangle.bottom, band.bottom);
  for (int row = std::max(triangle.top, band.top); row < bottom; ++row) {
    const double y = row + 0.5;
    const auto [begin, end] = columns_inside(triangle, y);
    for (int column = begin; column < end; ++column) {
      const double x = column + 0.5;
      Place place;
      place.at = static_cast<size_t>(row) * static_cast<size_t>(width) + static_cast<size_t>(column);
      place.inverse = made_up ? triangle.farthest * kFilled : static_cast<float>(triangle.inverse.at(x, y));
      if (place.inverse <= inverse[place.at]) continue;
      const double w = triangle.w.at(x, y);
      place.x = static_cast<float>(triangle.pixel_x.at(x, y) / w);
      place.y = static_cast<float>(triangle.pixel_y.at(x, y) / w);
      place.front = static_cast<float>(triangle.front.at(x, y) / w);
      if (filled) place.fill = color_of(triangle.fill, x, y, w);
      draw(place);
    }
  }
}

/// Draws a frame, with what fills its holes.
void draw_newest(const Pixels& pixels, const std::vector<ScreenTriangle>& triangles, const Band& band, Target& target,
                 Pixels& picture) {
  for (const ScreenTriangle& triangle : triangles) {
    const Sheet sheet = triangle.mesh->sheet;
    for_each_place(triangle, band, target.width, target.inverse, [&](const Place& place) {
      const Shown drawn = shown(pixels, triangle, place);
      if (sheet == Sheet::kNear && !drawn.own) return;
      const float inverse = sheet == Sheet::kFar && !drawn.own ? place.inverse * kContinued : place.inverse;
      if (inverse <= target.inverse[place.at]) return;
      target.inverse[place.at] = inverse;
      target.density[place.at] = drawn.own ? triangle.density : -1;
      put(picture, place.at, drawn.color);
    });
  }
}

/// Draws what a former frame shows, where the newest one shows nothing, or the same not as sharp. `most_off`: of its
/// colour from that of the newest, see distance().
void draw_rest(const Pixels& pixels, const std::vector<ScreenTriangle>& triangles, const Band& band,
               const Target& newest, int most_off, Target& target, Pixels& picture) {
  for (const ScreenTriangle& triangle : triangles) {
    const Sheet sheet = triangle.mesh->sheet;
    if (sheet == Sheet::kFill || sheet == Sheet::kSurroundings || triangle.mesh->background) continue;
    for_each_place(triangle, band, target.width, target.inverse, [&](const Place& place) {
      const float there = newest.inverse[place.at];
      const bool nothing = there < 0 || newest.density[place.at] < 0;
      const bool agrees = std::abs(place.inverse - there) <= kAgreement * std::max(place.inverse, there);
      const bool sharper = triangle.density >= newest.density[place.at] && triangle.cosine >= kLeastCosine;
      const bool wanted = nothing || (agrees && sharper);
      const bool certain = sheet == Sheet::kSurface;
      const Shown drawn = wanted || !certain ? shown(pixels, triangle, place) : Shown{};
      if (!drawn.own) return;
      target.inverse[place.at] = place.inverse;
      const bool alike = nothing || distance(drawn.color, color_at(&picture.bytes[4 * place.at])) <= most_off;
      if (wanted && alike) put(picture, place.at, drawn.color);
    });
  }
}

/// Calls `draw` for bands of rows, each on a thread of its own.
template <typename Draw>
void in_bands(int height, const Draw& draw) {
  const int bands = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kMaxBands);
  std::vector<std::jthread> threads;
  for (int i = 1; i < bands; ++i)
    threads.emplace_back([&, i] { draw(Band{height * i / bands, height * (i + 1) / bands}); });
  draw(Band{0, height / bands});
}

}  // namespace

WarpFrame make_warp_frame(Pixels pixels, const geometry::CameraFrame& camera, const DepthPlane& depth) {
  WarpMesh mesh = make_warp_mesh(depth, pixels.width, pixels.height);
  std::vector<Color> colors = fill_colors(pixels, depth);
  return {std::move(pixels), camera, std::move(mesh), std::move(colors), depth.seen_through};
}

Pixels warp(const WarpFrame& newest, const WarpFrame* rest, const geometry::CameraFrame& target,
            const std::array<uint8_t, 4>& background) {
  Pixels picture{target.width, target.height, {}};
  picture.bytes.resize(4 * static_cast<size_t>(target.width) * static_cast<size_t>(target.height));
  for (size_t at = 0; at < picture.bytes.size() / 4; ++at) put(picture, at, color_at(background.data()));
  std::vector<ScreenTriangle> below;
  std::vector<ScreenTriangle> above;
  {
    const std::jthread other([&] {
      if (rest) above = screen_triangles(*rest, target);
    });
    below = screen_triangles(newest, target);
  }
  const int most_off = rest && rest->seen_through ? kSameLook : std::numeric_limits<int>::max();
  Target seen(target);
  Target seen_above(target);
  in_bands(target.height, [&](const Band& band) {
    draw_newest(newest.pixels, below, band, seen, picture);
    if (rest) draw_rest(rest->pixels, above, band, seen, most_off, seen_above, picture);
  });
  return picture;
}

}  // namespace surfcast::warp
