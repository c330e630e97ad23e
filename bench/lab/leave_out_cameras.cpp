#include "lab/leave_out_cameras.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "base/contract.h"
#include "lab/nearest_points.h"

namespace surfcast::lab {
namespace {

constexpr double kViewAngle = 45;     // degrees
constexpr double kNearSpacings = 70;  ///< distance of near cameras: about 8 pixels to a spacing at 480 rows
constexpr double kEyeHeight = 1.7;    ///< of a person above the ground, metres
constexpr double kEyeSpacings = 4;    ///< least height of the eye above the ground, in spacings of the points there
constexpr double kClearSpacings = 2;  ///< free space around an eye
constexpr size_t kAround = 64;        ///< points whose median spacing is that of a place

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

/// The size and place of a scan without its strays, and its axes.
class Site {
 public:
  Site(std::span<const glm::dvec3> points, std::span<const double> spacings, bool z_up)
      : points_(points), spacings_(spacings), up_(z_up ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0)) {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (const glm::dvec3& p : points) values.push_back(p[axis]);
      std::ranges::sort(values);
      const auto at = [&](double share) {
        return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
      };
      low_[axis] = at(0.05);
      centre_[axis] = at(0.5);
      high_[axis] = at(0.95);
    }
    radius_ = std::max(0.5 * glm::distance(low_, high_), std::numeric_limits<double>::min());
    std::vector<double> sorted(spacings.begin(), spacings.end());
    std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2));
    spacing_ = sorted[sorted.size() / 2];
  }

  [[nodiscard]] std::span<const glm::dvec3> points() const { return points_; }
  [[nodiscard]] std::span<const double> spacings() const { return spacings_; }
  [[nodiscard]] const glm::dvec3& centre() const { return centre_; }
  [[nodiscard]] const glm::dvec3& low() const { return low_; }
  [[nodiscard]] const glm::dvec3& high() const { return high_; }
  [[nodiscard]] const glm::dvec3& up() const { return up_; }
  [[nodiscard]] double radius() const { return radius_; }
  [[nodiscard]] double spacing() const { return spacing_; }

  /// A unit vector by its direction over the ground and its elevation, degrees.
  [[nodiscard]] glm::dvec3 direction(double azimuth, double elevation) const {
    const glm::dvec3 east(1, 0, 0);
    const glm::dvec3 north = glm::cross(up_, east);
    const double level = std::cos(radians(elevation));
    return level * (std::cos(radians(azimuth)) * east + std::sin(radians(azimuth)) * north) +
           std::sin(radians(elevation)) * up_;
  }

  /// The point nearest to a place, and the median spacing of the points around it.
  [[nodiscard]] std::pair<glm::dvec3, double> surface_near(const glm::dvec3& place) const {
    const NearestPoints nearest = nearest_points(points_, std::array{place}, kAround);
    return {points_[nearest.of(0).front()], median_spacing(nearest.of(0))};
  }

  [[nodiscard]] double median_spacing(std::span<const uint32_t> points) const {
    std::vector<double> around;
    for (const uint32_t i : points) around.push_back(spacings_[i]);
    std::ranges::sort(around);
    return around[around.size() / 2];
  }

  [[nodiscard]] NamedCamera camera(std::string name, const glm::dvec3& eye, const glm::dvec3& target) const {
    return {std::move(name), {eye, target, up_, kViewAngle}};
  }

 private:
  std::span<const glm::dvec3> points_;
  std::span<const double> spacings_;
  glm::dvec3 up_;
  glm::dvec3 low_{0};
  glm::dvec3 centre_{0};
  glm::dvec3 high_{0};
  double radius_ = 0;
  double spacing_ = 0;
};

using Cameras = std::vector<NamedCamera>;

void look_from_outside(const Site& site, Cameras& cameras) {
  const auto add = [&](const char* name, double azimuth, double elevation, double distance) {
    const glm::dvec3 eye = site.centre() + distance * site.radius() * site.direction(azimuth, elevation);
    cameras.push_back(site.camera(name, eye, site.centre()));
  };
  add("above", 0, 89, 2);
  add("slanted 1", 40, 35, 2);
  add("slanted 2", 200, 20, 1.6);
}

/// Two cameras near the surface towards two directions; `away` is how far from the centre it is looked for, in radii.
void look_from_near(const Site& site, double away, double side, Cameras& cameras) {
  const std::array directions{site.direction(100, 40), site.direction(300, 25)};
  for (size_t i = 0; i < directions.size(); ++i) {
    const auto [target, spacing] = site.surface_near(site.centre() + away * site.radius() * directions[i]);
    const double distance = std::min(kNearSpacings * spacing, 2 * site.radius());
    cameras.push_back(site.camera("near " + std::to_string(i + 1), target + side * distance * directions[i], target));
  }
}

/// The ground by cells of a square grid: an eye over the lowest of the points of each cell, without the lowest 5 %.
class Ground {
 public:
  explicit Ground(const Site& site) : site_(site), cell_(site.radius() / 50) {
    std::map<std::pair<int64_t, int64_t>, std::vector<size_t>> cells;
    for (size_t i = 0; i < site.points().size(); ++i) cells[key(site.points()[i])].push_back(i);
    std::vector<glm::dvec3> lowest;
    for (auto& [place, members] : cells) lowest.push_back(lowest_of(members));
    add_eyes(lowest);
  }

  /// The free eye over the ground that is nearest to a place.
  [[nodiscard]] glm::dvec3 eye_near(const glm::dvec3& place) const {
    const NearestPoints nearest = nearest_points(site_.points(), eyes_, 1);
    double best = std::numeric_limits<double>::infinity();
    glm::dvec3 found = eyes_.front();
    for (size_t i = 0; i < eyes_.size(); ++i) {
      const double away = glm::length(level(eyes_[i] - place));
      if (nearest.squared_distances_of(i)[0] < clear_[i] * clear_[i] || away >= best) continue;
      best = away;
      found = eyes_[i];
    }
    return found;
  }

 private:
  [[nodiscard]] glm::dvec3 level(const glm::dvec3& v) const { return v - glm::dot(v, site_.up()) * site_.up(); }
  [[nodiscard]] std::pair<int64_t, int64_t> key(const glm::dvec3& p) const {
    const glm::dvec3 place = glm::floor((p - site_.centre()) / cell_);
    return {static_cast<int64_t>(place.x), static_cast<int64_t>(site_.up().z > 0 ? place.y : place.z)};
  }

  [[nodiscard]] glm::dvec3 lowest_of(std::vector<size_t>& members) const {
    std::ranges::sort(members, {}, [&](size_t i) { return glm::dot(site_.points()[i], site_.up()); });
    return site_.points()[members[members.size() / 20]];
  }

  /// The spacing is that of the points around, because a stray may be alone in its cell.
  void add_eyes(const std::vector<glm::dvec3>& lowest) {
    const NearestPoints nearest = nearest_points(site_.points(), lowest, kAround);
    for (size_t i = 0; i < lowest.size(); ++i) {
      const double spacing = std::max(site_.spacing(), site_.median_spacing(nearest.of(i)));
      eyes_.push_back(lowest[i] + std::max(kEyeHeight, kEyeSpacings * spacing) * site_.up());
      clear_.push_back(kClearSpacings * spacing);
    }
  }

  const Site& site_;
  double cell_;
  std::vector<glm::dvec3> eyes_;
  std::vector<double> clear_;  ///< free space that each eye needs, world units
};

void look_from_the_ground(const Site& site, Cameras& cameras) {
  const Ground ground(site);
  const glm::dvec3 middle = ground.eye_near(site.centre());
  for (int i = 0; i < 5; ++i) {
    const glm::dvec3 side = site.direction(72.0 * i, 0);
    const glm::dvec3 eye = ground.eye_near(site.centre() + 0.35 * site.radius() * side);
    cameras.push_back(site.camera("ground " + std::to_string(i + 1), eye, middle));
  }
}

/// The place within the scan that is farthest from all points.
glm::dvec3 emptiest_place(const Site& site) {
  constexpr int kSteps = 16;
  std::vector<glm::dvec3> places;
  for (int i = 0; i < kSteps * kSteps * kSteps; ++i) {
    const glm::dvec3 share = (glm::dvec3(i % kSteps, i / kSteps % kSteps, i / kSteps / kSteps) + 0.5) / double{kSteps};
    places.push_back(site.low() + (0.2 + 0.6 * share) * (site.high() - site.low()));
  }
  const NearestPoints nearest = nearest_points(site.points(), places, 1);
  const auto farthest = std::ranges::max_element(nearest.squared_distances);
  return places[static_cast<size_t>(farthest - nearest.squared_distances.begin())];
}

void look_around_inside(const Site& site, Cameras& cameras) {
  const glm::dvec3 eye = emptiest_place(site);
  for (int i = 0; i < 5; ++i) {
    cameras.push_back(site.camera("inside " + std::to_string(i + 1), eye, eye + site.direction(72.0 * i + 10, -10)));
  }
}

void look_all_around(const Site& site, Cameras& cameras) {
  for (int i = 0; i < 5; ++i) {
    const glm::dvec3 eye = site.centre() + 2.2 * site.radius() * site.direction(72.0 * i + 15, 10);
    cameras.push_back(site.camera("around " + std::to_string(i + 1), eye, site.centre()));
  }
}

/// Around the scene as the sensor at the origin saw it.
void look_like_the_sensor(const Site& site, Cameras& cameras) {
  const glm::dvec3 back = -site.centre();
  const glm::dvec3 up = site.up();
  const glm::dvec3 side = glm::normalize(glm::cross(back, up)) * glm::length(back);
  const auto add = [&](std::string name, double turn, double lift, double distance) {
    const glm::dvec3 level = std::cos(radians(turn)) * back + std::sin(radians(turn)) * side;
    const glm::dvec3 away = std::cos(radians(lift)) * level + std::sin(radians(lift)) * glm::length(back) * up;
    cameras.push_back(site.camera(std::move(name), site.centre() + distance * away, site.centre()));
  };
  add("beside", 3, 0, 1);
  add("above", 0, 50, 1.2);
  add("below", 0, -30, 1.1);
  for (int i = 0; i < 5; ++i) add("around " + std::to_string(i + 1), 20.0 * i - 40, i % 2 == 0 ? 15 : -10, 1.1);
  add("near 1", 15, 10, 0.4);
  add("near 2", -20, -5, 0.3);
}

}  // namespace

std::optional<Place> place_named(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Place>, 5> kNames{{{"ground", Place::kGround},
                                                                      {"sweep", Place::kSweep},
                                                                      {"object", Place::kObject},
                                                                      {"room", Place::kRoom},
                                                                      {"sensor", Place::kSensor}}};
  const auto* found = std::ranges::find(kNames, name, &std::pair<std::string_view, Place>::first);
  return found == kNames.end() ? std::nullopt : std::optional(found->second);
}

PlacedScan placed_scan(const std::string& argument) {
  const size_t colon = argument.find(':');
  if (colon == std::string::npos) return {std::nullopt, argument};
  const std::optional<Place> place = place_named(argument.substr(0, colon));
  return {place, place ? argument.substr(colon + 1) : argument};
}

std::vector<NamedCamera> leave_out_cameras(std::span<const glm::dvec3> points, std::span<const double> spacings,
                                           Place place, bool z_up) {
  SURFCAST_EXPECTS(!points.empty() && points.size() == spacings.size());
  const Site site(points, spacings, z_up);
  Cameras cameras;
  if (place == Place::kSensor) {
    look_like_the_sensor(site, cameras);
    return cameras;
  }
  look_from_outside(site, cameras);
  look_from_near(site, place == Place::kGround || place == Place::kSweep ? 0 : 1, place == Place::kRoom ? -1 : 1,
                 cameras);
  if (place == Place::kObject) look_all_around(site, cameras);
  if (place == Place::kRoom) look_around_inside(site, cameras);
  if (place == Place::kGround || place == Place::kSweep) look_from_the_ground(site, cameras);
  if (place == Place::kSweep) {
    const glm::dvec3 beside = 10 * site.spacing() * site.direction(90, 0);
    cameras.push_back(site.camera("beside", beside, beside + site.direction(0, 0)));
  }
  return cameras;
}

}  // namespace surfcast::lab
