#include "service/place_members.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <utility>

#include "crs/transformation.h"
#include "model/georeference.h"

namespace surfcast::service {
namespace {

/// The centre of a block, the middles of its faces (low and high along each axis), and its corners.
constexpr size_t kFirstCorner = 7;
using Probes = std::array<glm::dvec3, kFirstCorner + 8>;

/// Where the middle of the low face along an axis is; that of the high one follows.
size_t low_face(int axis) {
  return 1 + 2 * static_cast<size_t>(axis);
}

/// Half the size of a block, at least half a spacing, so that derivatives are those of a length.
glm::dvec3 half_size(const ldc::BlockEntry& block) {
  const double least = block.spacing > 0 ? block.spacing : 1;
  return 0.5 * glm::max(block.bounds.size(), glm::dvec3(least));
}

Probes probes_of(const glm::dvec3& centre, const glm::dvec3& half) {
  Probes probes;
  probes[0] = centre;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step(0);
    step[axis] = half[axis];
    probes[low_face(axis)] = centre - step;
    probes[low_face(axis) + 1] = centre + step;
  }
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 sides(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    probes[kFirstCorner + static_cast<size_t>(corner)] = centre + (2.0 * sides - 1.0) * half;
  }
  return probes;
}

/// The affine map with the derivative of the transformation at the centre, by central differences.
glm::dmat4x3 map_of(const glm::dvec3& centre, const glm::dvec3& half, const Probes& there) {
  glm::dmat4x3 map;
  for (int axis = 0; axis < 3; ++axis) {
    const size_t low = low_face(axis);
    map[axis] = (there[low + 1] - there[low]) / (2 * half[axis]);
  }
  map[3] = there[0] - glm::dmat3(map[0], map[1], map[2]) * centre;
  return map;
}

/// The largest distance of a corner as the map has it from where it is; infinite if it is nowhere.
double error_of(const glm::dmat4x3& map, const Probes& here, const Probes& there) {
  double largest = 0;
  for (size_t i = kFirstCorner; i < here.size(); ++i) {
    const double distance = glm::length(map * glm::dvec4(here[i], 1) - there[i]);
    if (!std::isfinite(distance)) return distance;
    largest = std::max(largest, distance);
  }
  return largest;
}

/// Names the member in an error.
Error error_about(const model::Member& member, const Error& error) {
  return {error.kind, member.name + ": cannot be shown in the coordinate system of the first model: " + error.message};
}

Status place_blocks(const crs::Transformation& way, model::Member& member) {
  for (const ldc::BlockEntry& block : member.model->blocks()) {
    const glm::dvec3 centre = block.bounds.centre();
    const glm::dvec3 half = half_size(block);
    const Probes here = probes_of(centre, half);
    Probes there = here;
    way.apply(there);
    const glm::dmat4x3 map = map_of(centre, half, there);
    if (!(error_of(map, here, there) <= kMaxPlaceError * block.spacing * way.length_factor())) {
      return fail(error_about(member, {ErrorKind::kUnsupported, "a block of it is too large for that"}));
    }
    member.places.push_back(map);
  }
  return {};
}

Result<crs::Transformation> way_between(const model::CoordinateSystem& from, const model::CoordinateSystem& to,
                                        const geometry::Box& bounds) {
  const Result<crs::CoordinateSystem> source = crs::read_system(from.wkt);
  if (!source) return fail(source);
  const Result<crs::CoordinateSystem> target = crs::read_system(to.wkt);
  if (!target) return fail(target);
  return crs::Transformation::between(*source, *target, bounds);
}

Status place_in(const model::CoordinateSystem& from, const model::CoordinateSystem& to, model::Member& member) {
  const Result<crs::Transformation> way = way_between(from, to, member.model->info().bounds);
  if (!way) return fail(error_about(member, way.error()));
  return place_blocks(*way, member);
}

/// Whether coordinates mean the same in both; PROJ is asked if the texts differ.
bool are_same(const model::CoordinateSystem& a, const model::CoordinateSystem& b) {
  if (a.wkt == b.wkt) return true;
  const Result<crs::CoordinateSystem> one = crs::read_system(a.wkt);
  const Result<crs::CoordinateSystem> other = crs::read_system(b.wkt);
  return one && other && crs::are_same(*one, *other);
}

}  // namespace

Status MemberPlacer::place(model::Member& member) {
  const Result<model::Georeference> georeference = member.model->georeference();
  if (!georeference) return fail(georeference);
  if (!georeference->known()) return {};
  if (!common_) common_ = georeference->system;
  if (are_same(georeference->system, *common_)) return {};
  return place_in(georeference->system, *common_, member);
}

Status place_members(std::vector<model::Member>& members) {
  MemberPlacer placer;
  for (model::Member& member : members) {
    if (Status placed = placer.place(member); !placed) return placed;
  }
  return {};
}

}  // namespace surfcast::service
