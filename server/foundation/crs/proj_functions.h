#pragma once

#include <span>
#include <string_view>

#include "crs/proj_module.h"

/// The functions of the module, see ProjFunctions.
namespace surfcast::crs::proj {

Result<CoordinateSystem> read_system(std::string_view text);
bool are_same(const CoordinateSystem& a, const CoordinateSystem& b);
Result<CoordinateSystem> metric_system(const CoordinateSystem& system, const geometry::Box& degrees);
geometry::Box degrees_of(const CoordinateSystem& system, const geometry::Box& bounds);
bool is_in_area_of_use(const CoordinateSystem& system, const geometry::Box& bounds);
Result<Operation> find_operation(const CoordinateSystem& from, const CoordinateSystem& to, const geometry::Box& bounds);
void apply(const void* handle, std::span<glm::dvec3> positions);

}  // namespace surfcast::crs::proj
