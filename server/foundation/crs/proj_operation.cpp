#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <mutex>
#include <numbers>
#include <utility>
#include <vector>

#include "crs/proj_functions.h"
#include "crs/proj_objects.h"

namespace surfcast::crs::proj {
namespace {

/// An operation and the context it belongs to, for one thread at a time. Members are destroyed in reverse order.
struct Worker {
  Context context;
  Object operation;
};

struct Systems {
  Object from;
  Object to;
};

/// The two systems as PROJ has to see them, so that heights become what Transformation promises.
Systems systems_of(PJ_CONTEXT* context, const CoordinateSystem& from, const CoordinateSystem& to, bool heights) {
  const auto prepared = [&](const CoordinateSystem& system) -> Object {
    Object parsed = parse_system(context, system.wkt);
    if (!parsed) return nullptr;
    if (!heights) return horizontal_part(context, parsed.get());
    return system.heights ? std::move(parsed) : Object(proj_crs_promote_to_3D(context, nullptr, parsed.get()));
  };
  return {prepared(from), prepared(to)};
}

bool is_compound(PJ_CONTEXT* context, const CoordinateSystem& system) {
  const Object parsed = parse_system(context, system.wkt);
  return parsed && proj_get_type(parsed.get()) == PJ_TYPE_COMPOUND_CRS;
}

/// True if z is transformed, not only scaled.
bool transforms_heights(PJ_CONTEXT* context, const CoordinateSystem& from, const CoordinateSystem& to) {
  if (from.heights && to.heights) return true;
  const auto ellipsoidal = [context](const CoordinateSystem& s) { return s.heights && !is_compound(context, s); };
  return ellipsoidal(from) || ellipsoidal(to);
}

ObjectList operations_between(PJ_CONTEXT* context, const Systems& systems, const geometry::Box& degrees) {
  const FactoryContext factory(proj_create_operation_factory_context(context, nullptr));
  if (!factory) return nullptr;
  if (!degrees.empty()) {
    proj_operation_factory_context_set_area_of_interest(context, factory.get(), degrees.min.x, degrees.min.y,
                                                        degrees.max.x, degrees.max.y);
  }
  proj_operation_factory_context_set_spatial_criterion(context, factory.get(),
                                                       PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
  proj_operation_factory_context_set_grid_availability_use(context, factory.get(),
                                                           PROJ_GRID_AVAILABILITY_DISCARD_OPERATION_IF_MISSING_GRID);
  return ObjectList(proj_create_operations(context, systems.from.get(), systems.to.get(), factory.get()));
}

void transform(PJ* operation, std::span<glm::dvec3> positions) {
  constexpr size_t kStride = sizeof(glm::dvec3);
  const size_t count = positions.size();
  if (count == 0) return;
  glm::dvec3& first = positions.front();
  proj_errno_reset(operation);
  proj_trans_generic(operation, PJ_FWD, &first.x, kStride, count, &first.y, kStride, count, &first.z, kStride, count,
                     nullptr, 0, 0);
}

bool is_finite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// Steps of a metre to the east, north and up at a place, in coordinates of the system; along the axes of others.
glm::dmat3 steps_at(const CoordinateSystem& system, const glm::dvec3& place) {
  if (system.kind != SystemKind::kGeographic) {
    return {{1 / system.unit, 0, 0}, {0, 1 / system.unit, 0}, {0, 0, 1 / system.height_unit}};
  }
  constexpr double kDegreesPerMetre = 180 / (std::numbers::pi * 6'371'000.0);  // on the mean sphere
  const double parallel = std::max(std::cos(place.y * std::numbers::pi / 180), 1e-6);
  return {{kDegreesPerMetre / parallel, 0, 0}, {0, kDegreesPerMetre, 0}, {0, 0, 1 / system.height_unit}};
}

/// The nearest rotation by Gram and Schmidt, the vertical first.
glm::dmat3 orthonormal(const glm::dmat3& m) {
  const glm::dvec3 z = glm::normalize(m[2]);
  const glm::dvec3 x = glm::normalize(m[0] - z * glm::dot(m[0], z));
  return {x, glm::cross(z, x), z};
}

/// An operation that several threads may apply at once.
struct SharedOperation {
  double scale_before = 1;  ///< of z
  double scale_after = 1;
  mutable std::mutex mutex;
  mutable std::vector<std::unique_ptr<Worker>> idle;  ///< clones that no thread uses now
  std::unique_ptr<Worker> original;                   ///< cloned under the lock, never applied afterwards

  [[nodiscard]] std::unique_ptr<Worker> borrow() const {
    const std::lock_guard lock(mutex);
    if (!idle.empty()) {
      std::unique_ptr<Worker> worker = std::move(idle.back());
      idle.pop_back();
      return worker;
    }
    auto worker = std::make_unique<Worker>(Worker{make_context(), nullptr});
    worker->operation.reset(proj_clone(worker->context.get(), original->operation.get()));
    return worker;
  }

  void give_back(std::unique_ptr<Worker> worker) const {
    const std::lock_guard lock(mutex);
    idle.push_back(std::move(worker));
  }

  void apply(PJ* operation, std::span<glm::dvec3> positions) const {
    for (glm::dvec3& p : positions) p.z *= scale_before;
    transform(operation, positions);
    for (glm::dvec3& p : positions) {
      p.z *= scale_after;
      if (!is_finite(p)) p = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
    }
  }
};

/// The turn of an operation at the middle of the box; none if it does not carry the middle and its surroundings.
std::optional<glm::dmat3> turn_of(const SharedOperation& operation, const CoordinateSystem& from,
                                  const geometry::Box& bounds) {
  const glm::dvec3 middle = (bounds.min + bounds.max) * 0.5;
  const glm::dmat3 steps = steps_at(from, middle);
  std::array<glm::dvec3, 4> places{middle, middle + steps[0], middle + steps[1], middle + steps[2]};
  operation.apply(operation.original->operation.get(), places);
  if (!std::all_of(places.begin(), places.end(), is_finite)) return std::nullopt;
  return orthonormal({places[1] - places[0], places[2] - places[0], places[3] - places[0]});
}

/// Metres; none: unknown.
std::optional<double> accuracy_of(PJ_CONTEXT* context, const PJ* operation) {
  // A conversion is exact by definition, and PROJ states no accuracy of it.
  if (proj_get_type(operation) == PJ_TYPE_CONVERSION) return 0.0;
  const double accuracy = proj_coordoperation_get_accuracy(context, operation);
  if (accuracy < 0 || proj_coordoperation_has_ballpark_transformation(context, operation) != 0) return std::nullopt;
  return accuracy;
}

}  // namespace

Result<Operation> find_operation(const CoordinateSystem& from, const CoordinateSystem& to,
                                 const geometry::Box& bounds) {
  auto shared = std::make_unique<SharedOperation>();
  shared->original = std::make_unique<Worker>(Worker{make_context(), nullptr});
  PJ_CONTEXT* context = shared->original->context.get();
  const auto impossible = [&](const std::string& why) {
    return fail(ErrorKind::kUnsupported, "cannot be brought from " + from.name + " into " + to.name + ": " + why);
  };
  if (from.kind == SystemKind::kOther || to.kind == SystemKind::kOther) {
    return impossible("a local system has no place on the earth");
  }
  const bool heights = transforms_heights(context, from, to);
  if (!heights) shared->scale_before = from.height_unit / to.height_unit;
  // Systems that state no heights are given ellipsoidal ones in metres.
  if (heights && !from.heights) shared->scale_before = from.height_unit;
  if (heights && !to.heights) shared->scale_after = 1 / to.height_unit;
  const Systems systems = systems_of(context, from, to, heights);
  if (!systems.from || !systems.to) return impossible(last_problem(context));
  const ObjectList found = operations_between(context, systems, proj::degrees_of(from, bounds));
  const int count = found ? proj_list_get_count(found.get()) : 0;
  for (int i = 0; i < count; ++i) {
    const Object operation(proj_list_get(context, found.get(), i));
    shared->original->operation.reset(proj_normalize_for_visualization(context, operation.get()));
    if (!shared->original->operation) continue;
    const std::optional<glm::dmat3> turn = turn_of(*shared, from, bounds);
    if (!turn) continue;
    return Operation{proj_get_name(operation.get()),
                     accuracy_of(context, operation.get()),
                     from.unit / to.unit,
                     *turn,
                     {shared.release(), [](void* handle) { delete static_cast<SharedOperation*>(handle); }}};
  }
  return impossible(count > 0 ? "the points are where no operation leads from" : last_problem(context));
}

void apply(const void* handle, std::span<glm::dvec3> positions) {
  const auto& shared = *static_cast<const SharedOperation*>(handle);
  std::unique_ptr<Worker> worker = shared.borrow();
  shared.apply(worker->operation.get(), positions);
  shared.give_back(std::move(worker));
}

}  // namespace surfcast::crs::proj
