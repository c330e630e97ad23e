#pragma once

#include <glm/mat3x3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "crs/coordinate_system.h"

namespace surfcast::crs {

/// An operation of PROJ that was found for a Transformation. The types that cross the border of the module have no
/// virtual functions, because program and module each have their own type information.
struct Operation {
  std::string name;
  std::optional<double> accuracy;                 ///< metres
  double length_factor = 1;                       ///< see Transformation::length_factor
  glm::dmat3 turn{1};                             ///< see Transformation::turn
  std::unique_ptr<void, void (*)(void*)> handle;  ///< what ProjFunctions::apply needs
};

/// What the module does, as coordinate_system.h and transformation.h describe it.
struct ProjFunctions {
  Result<CoordinateSystem> (*read_system)(std::string_view text);
  bool (*are_same)(const CoordinateSystem& a, const CoordinateSystem& b);
  Result<CoordinateSystem> (*metric_system)(const CoordinateSystem& system, const geometry::Box& degrees);
  geometry::Box (*degrees_of)(const CoordinateSystem& system, const geometry::Box& bounds);
  bool (*is_in_area_of_use)(const CoordinateSystem& system, const geometry::Box& bounds);
  Result<Operation> (*find_operation)(const CoordinateSystem& from, const CoordinateSystem& to,
                                      const geometry::Box& bounds);
  void (*apply)(const void* handle, std::span<glm::dvec3> positions);
};

/// The file of the module, see load_function().
inline constexpr const char* kProjModule = "coordinate_systems.so";
/// The function that the module exports.
inline constexpr const char* kProjSymbol = "surfcast_proj_functions";
using ProjSymbolType = const ProjFunctions*();

}  // namespace surfcast::crs

/// Exported by the module.
extern "C" [[gnu::visibility("default")]] surfcast::crs::ProjSymbolType surfcast_proj_functions;
