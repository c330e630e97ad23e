#include "crs/coordinate_system.h"

#include "crs/load_proj.h"

namespace surfcast::crs {

Result<CoordinateSystem> read_system(std::string_view text) {
  const Result<const ProjFunctions*>& functions = load_proj();
  if (!functions) return fail(functions);
  return (*functions)->read_system(text);
}

bool are_same(const CoordinateSystem& a, const CoordinateSystem& b) {
  return a.wkt == b.wkt || loaded_proj().are_same(a, b);
}

Result<CoordinateSystem> metric_system(const CoordinateSystem& system, const geometry::Box& degrees) {
  return loaded_proj().metric_system(system, degrees);
}

geometry::Box degrees_of(const CoordinateSystem& system, const geometry::Box& bounds) {
  return loaded_proj().degrees_of(system, bounds);
}

bool is_in_area_of_use(const CoordinateSystem& system, const geometry::Box& bounds) {
  return loaded_proj().is_in_area_of_use(system, bounds);
}

}  // namespace surfcast::crs
