#include "crs/proj_objects.h"

#include <optional>

namespace surfcast::crs {
namespace {

std::string text_or_empty(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

SystemKind kind_of(PJ_TYPE type) {
  switch (type) {
    case PJ_TYPE_PROJECTED_CRS:
      return SystemKind::kProjected;
    case PJ_TYPE_GEOGRAPHIC_2D_CRS:
    case PJ_TYPE_GEOGRAPHIC_3D_CRS:
      return SystemKind::kGeographic;
    case PJ_TYPE_GEOCENTRIC_CRS:
      return SystemKind::kGeocentric;
    default:
      return SystemKind::kOther;
  }
}

/// The factor of an axis to metres or radians; none if there is no such axis.
std::optional<double> unit_of_axis(PJ_CONTEXT* context, const PJ* system, int axis) {
  const Object axes(proj_crs_get_coordinate_system(context, system));
  double factor = 0;
  if (!axes || axis >= proj_cs_get_axis_count(context, axes.get()) ||
      proj_cs_get_axis_info(context, axes.get(), axis, nullptr, nullptr, nullptr, &factor, nullptr, nullptr, nullptr) ==
          0) {
    return std::nullopt;
  }
  return factor > 0 ? std::optional(factor) : std::nullopt;
}

/// "EPSG:25832"; of compounds without a code of their own, the codes of both parts.
std::string id_of(PJ_CONTEXT* context, const PJ* system) {
  const std::string authority = text_or_empty(proj_get_id_auth_name(system, 0));
  const std::string code = text_or_empty(proj_get_id_code(system, 0));
  if (!authority.empty() && !code.empty()) return authority + ":" + code;
  if (proj_get_type(system) != PJ_TYPE_COMPOUND_CRS) return {};
  const Object horizontal(proj_crs_get_sub_crs(context, system, 0));
  const Object vertical(proj_crs_get_sub_crs(context, system, 1));
  if (!horizontal || !vertical) return {};
  const std::string first = id_of(context, horizontal.get());
  const std::string second = id_of(context, vertical.get());
  const size_t colon = first.find(':');
  if (first.empty() || second.compare(0, colon + 1, first, 0, colon + 1) != 0) return {};
  return first + "+" + second.substr(colon + 1);
}

std::string wkt_of(PJ_CONTEXT* context, const PJ* system) {
  const char* const options[] = {"MULTILINE=NO", nullptr};
  return text_or_empty(proj_as_wkt(context, system, PJ_WKT2_2019, options));
}

}  // namespace

Context make_context() {
  Context context(proj_context_create());
  proj_log_level(context.get(), PJ_LOG_NONE);
  proj_context_set_enable_network(context.get(), 0);
  return context;
}

Object parse_system(PJ_CONTEXT* context, const std::string& wkt) {
  Object system(proj_create_from_wkt(context, wkt.c_str(), nullptr, nullptr, nullptr));
  if (!system || proj_is_crs(system.get()) == 0) return nullptr;
  if (proj_get_type(system.get()) == PJ_TYPE_BOUND_CRS) return Object(proj_get_source_crs(context, system.get()));
  return system;
}

Object horizontal_part(PJ_CONTEXT* context, const PJ* system) {
  switch (proj_get_type(system)) {
    case PJ_TYPE_COMPOUND_CRS: {
      const Object first(proj_crs_get_sub_crs(context, system, 0));
      return first ? horizontal_part(context, first.get()) : nullptr;
    }
    case PJ_TYPE_BOUND_CRS: {
      const Object inner(proj_get_source_crs(context, system));
      return inner ? horizontal_part(context, inner.get()) : nullptr;
    }
    case PJ_TYPE_GEOCENTRIC_CRS:
      return Object(proj_clone(context, system));
    default:
      return Object(proj_crs_demote_to_2D(context, nullptr, system));
  }
}

CoordinateSystem describe(PJ_CONTEXT* context, const PJ* system) {
  CoordinateSystem described{text_or_empty(proj_get_name(system)), id_of(context, system), wkt_of(context, system)};
  const bool compound = proj_get_type(system) == PJ_TYPE_COMPOUND_CRS;
  const Object horizontal = horizontal_part(context, system);
  if (!horizontal) return described;
  described.kind = kind_of(proj_get_type(horizontal.get()));
  if (described.kind != SystemKind::kGeographic)
    described.unit = unit_of_axis(context, horizontal.get(), 0).value_or(1);
  std::optional<double> height;
  if (compound) {
    const Object vertical(proj_crs_get_sub_crs(context, system, 1));
    if (vertical) height = unit_of_axis(context, vertical.get(), 0);
  } else {
    height = unit_of_axis(context, system, 2);
  }
  described.heights = height.has_value();
  described.height_unit = height.value_or(described.unit);
  return described;
}

double vertical_unit(PJ_CONTEXT* context, const PJ* vertical) {
  return unit_of_axis(context, vertical, 0).value_or(1);
}

std::string last_problem(PJ_CONTEXT* context) {
  const int code = proj_context_errno(context);
  return code == 0 ? std::string("PROJ knows no way") : text_or_empty(proj_context_errno_string(context, code));
}

}  // namespace surfcast::crs
