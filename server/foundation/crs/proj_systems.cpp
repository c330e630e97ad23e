#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <utility>

#include "crs/proj_functions.h"
#include "crs/proj_objects.h"

namespace surfcast::crs::proj {
namespace {

/// The code of an authority, like EPSG:25832+7837. Nothing else is given to proj_create, which would also read files.
bool is_code(std::string_view text) {
  const size_t colon = text.find(':');
  if (colon == std::string_view::npos || colon == 0 || colon + 1 == text.size()) return false;
  const auto is_letter = [](unsigned char c) { return std::isalnum(c) != 0; };
  const auto is_digit = [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("+@_.").find(static_cast<char>(c)) != std::string_view::npos;
  };
  return std::all_of(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(colon), is_letter) &&
         std::all_of(text.begin() + static_cast<std::ptrdiff_t>(colon) + 1, text.end(), is_digit) &&
         text.substr(0, colon) != "init";
}

/// The first words of a text that is no system, for a line of an error.
std::string beginning(std::string_view text) {
  constexpr size_t kShown = 60;
  std::string shown(text.substr(0, kShown));
  std::replace_if(
      shown.begin(), shown.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  return text.size() > kShown ? shown + "..." : shown;
}

/// A system and a unit of length by their codes, as GeoKeys state them.
struct CodeAndUnit {
  std::string code;
  std::string unit;  ///< "0": the system's own
};

/// "26918@9003"; without "@", the system's own unit.
CodeAndUnit split_unit(std::string_view text) {
  const size_t at = text.find('@');
  if (at == std::string_view::npos) return {std::string(text), "0"};
  return {std::string(text.substr(0, at)), std::string(text.substr(at + 1))};
}

struct Unit {
  std::string name;
  double metres = 0;
};

std::optional<Unit> length_unit(PJ_CONTEXT* context, const std::string& code) {
  const char* name = nullptr;
  const char* category = nullptr;
  double metres = 0;
  if (proj_uom_get_info_from_database(context, "EPSG", code.c_str(), &name, &metres, &category) == 0) return {};
  if (std::string_view(category) != "linear" || !(metres > 0)) return {};
  return Unit{name, metres};
}

/// The system with another unit of length; itself if it has that one, or if the unit is not known.
Object with_unit(PJ_CONTEXT* context, Object system, const std::string& code) {
  const std::optional<Unit> unit = length_unit(context, code);
  if (!system || !unit || describe(context, system.get()).unit == unit->metres) return system;
  return Object(
      proj_crs_alter_cs_linear_unit(context, system.get(), unit->name.c_str(), unit->metres, "EPSG", code.c_str()));
}

/// Heights as GeoKeys state them. Null if nothing is known but that there are some.
Object vertical_system(PJ_CONTEXT* context, const CodeAndUnit& stated) {
  Object system(stated.code == "0" ? nullptr : proj_create(context, ("EPSG:" + stated.code).c_str()));
  const std::optional<Unit> unit = length_unit(context, stated.unit);
  if (system && proj_get_type(system.get()) == PJ_TYPE_VERTICAL_CRS) {
    if (!unit || vertical_unit(context, system.get()) == unit->metres) return system;
    return Object(proj_crs_alter_cs_linear_unit(context, system.get(), unit->name.c_str(), unit->metres, "EPSG",
                                                stated.unit.c_str()));
  }
  if (!unit) return nullptr;
  return Object(proj_create_vertical_crs(context, "unknown height", "unknown", unit->name.c_str(), unit->metres));
}

/// As coordinate_system.h describes it.
Object parse_geo_keys(PJ_CONTEXT* context, const std::string& text) {
  const size_t plus = text.find('+');
  const CodeAndUnit stated = split_unit(std::string_view(text).substr(0, plus));
  Object horizontal = with_unit(context, Object(proj_create(context, stated.code.c_str())), stated.unit);
  if (!horizontal || proj_is_crs(horizontal.get()) == 0) return nullptr;
  if (plus == std::string::npos) return horizontal;
  const Object vertical = vertical_system(context, split_unit(std::string_view(text).substr(plus + 1)));
  if (!vertical || vertical_unit(context, vertical.get()) == describe(context, horizontal.get()).unit) {
    return horizontal;
  }
  const std::string name =
      std::string(proj_get_name(horizontal.get())) + " + " + std::string(proj_get_name(vertical.get()));
  return Object(proj_create_compound_crs(context, name.c_str(), horizontal.get(), vertical.get()));
}

Object parse_text(PJ_CONTEXT* context, const std::string& text) {
  if (!is_code(text)) return parse_system(context, text);
  if (text.find('@') != std::string::npos) return parse_geo_keys(context, text);
  Object system(proj_create(context, text.c_str()));
  return system && proj_is_crs(system.get()) != 0 ? std::move(system) : nullptr;
}

/// The zone of the universal transverse Mercator system, 1 to 60.
int utm_zone(double longitude) {
  return std::clamp(static_cast<int>(std::floor((longitude + 180) / 6)) + 1, 1, 60);
}

/// The geographic system of the datum that a geographic or geocentric system is on, in two dimensions.
Object geographic_base(PJ_CONTEXT* context, const PJ* horizontal) {
  if (proj_get_type(horizontal) != PJ_TYPE_GEOCENTRIC_CRS) return Object(proj_clone(context, horizontal));
  const Object datum(proj_crs_get_datum_forced(context, horizontal));
  const Object axes(proj_create_ellipsoidal_2D_cs(context, PJ_ELLPS2D_LATITUDE_LONGITUDE, nullptr, 0));
  if (!datum || !axes) return nullptr;
  return Object(proj_create_geographic_crs_from_datum(context, proj_get_name(horizontal), datum.get(), axes.get()));
}

Object utm_on(PJ_CONTEXT* context, const PJ* base, const glm::dvec2& degrees) {
  const int zone = utm_zone(degrees.x);
  const bool north = degrees.y >= 0;
  const Object conversion(proj_create_conversion_utm(context, zone, north ? 1 : 0));
  const Object axes(proj_create_cartesian_2D_cs(context, PJ_CART2D_EASTING_NORTHING, nullptr, 0));
  if (!conversion || !axes) return nullptr;
  const std::string name =
      std::string(proj_get_name(base)) + " / UTM zone " + std::to_string(zone) + (north ? "N" : "S");
  return Object(proj_create_projected_crs(context, name.c_str(), base, conversion.get(), axes.get()));
}

/// The same system as an authority states it, if one has it.
Object identified(PJ_CONTEXT* context, Object system) {
  int* confidence = nullptr;
  const ObjectList found(proj_identify(context, system.get(), "EPSG", nullptr, &confidence));
  const bool certain = found && proj_list_get_count(found.get()) > 0 && confidence[0] == 100;
  proj_int_list_destroy(confidence);
  return certain ? Object(proj_list_get(context, found.get(), 0)) : std::move(system);
}

}  // namespace

Result<CoordinateSystem> read_system(std::string_view text) {
  const Context context = make_context();
  const Object system = parse_text(context.get(), std::string(text));
  if (!system) {
    return fail(ErrorKind::kInvalidInput, "not a coordinate system that PROJ knows: " + beginning(text));
  }
  CoordinateSystem described = describe(context.get(), system.get());
  if (described.wkt.empty()) {
    return fail(ErrorKind::kUnsupported, "a coordinate system that cannot be written as WKT: " + beginning(text));
  }
  return described;
}

bool are_same(const CoordinateSystem& a, const CoordinateSystem& b) {
  const Context context = make_context();
  const Object first = parse_system(context.get(), a.wkt);
  const Object second = parse_system(context.get(), b.wkt);
  return first && second &&
         proj_is_equivalent_to_with_ctx(context.get(), first.get(), second.get(),
                                        PJ_COMP_EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS) != 0;
}

Result<CoordinateSystem> metric_system(const CoordinateSystem& system, const geometry::Box& degrees) {
  if (system.is_metric()) return system;
  const Context context = make_context();
  const auto impossible = [&] {
    return fail(ErrorKind::kUnsupported, "no metric system for " + system.name + ": " + last_problem(context.get()));
  };
  const Object parsed = parse_system(context.get(), system.wkt);
  if (!parsed) return impossible();
  const Object horizontal = horizontal_part(context.get(), parsed.get());
  if (!horizontal) return impossible();
  if (system.kind == SystemKind::kProjected) return describe(context.get(), horizontal.get());
  if (degrees.empty()) {
    return fail(ErrorKind::kInvalidInput, "the points are not where " + system.name + " has coordinates");
  }
  const Object base = geographic_base(context.get(), horizontal.get());
  Object utm = base ? utm_on(context.get(), base.get(), glm::dvec2((degrees.min + degrees.max) * 0.5)) : nullptr;
  if (!utm) return impossible();
  const Object known = identified(context.get(), std::move(utm));
  return describe(context.get(), known.get());
}

geometry::Box degrees_of(const CoordinateSystem& system, const geometry::Box& bounds) {
  geometry::Box degrees;
  if (bounds.empty() || system.kind == SystemKind::kOther) return degrees;
  const Context context = make_context();
  const Object parsed = parse_system(context.get(), system.wkt);
  const Object horizontal = parsed ? horizontal_part(context.get(), parsed.get()) : nullptr;
  constexpr double kFarthestHeight = 1e6;  // metres
  const Object wgs84(proj_create(context.get(), "EPSG:4979"));
  if (!horizontal || !wgs84) return degrees;
  const Object raw(proj_create_crs_to_crs_from_pj(context.get(), horizontal.get(), wgs84.get(), nullptr, nullptr));
  const Object to_degrees(raw ? proj_normalize_for_visualization(context.get(), raw.get()) : nullptr);
  if (!to_degrees) return degrees;
  for (int corner = 0; corner < 9; ++corner) {
    glm::dvec3 p = (bounds.min + bounds.max) * 0.5;  // the last one; the corners of a box of a few metres may overflow
    for (int axis = 0; corner < 8 && axis < 3; ++axis) {
      p[axis] = ((corner >> axis) & 1) != 0 ? bounds.max[axis] : bounds.min[axis];
    }
    const PJ_COORD moved = proj_trans(to_degrees.get(), PJ_FWD, proj_coord(p.x, p.y, p.z, HUGE_VAL));
    if (std::isfinite(moved.xyz.x) && std::isfinite(moved.xyz.y) && std::abs(moved.xyz.y) <= 90 &&
        std::abs(moved.xyz.z) <= kFarthestHeight) {
      degrees.include(glm::dvec3(moved.xyz.x, moved.xyz.y, 0));
    }
  }
  return degrees;
}

bool is_in_area_of_use(const CoordinateSystem& system, const geometry::Box& bounds) {
  const Context context = make_context();
  const Object parsed = parse_system(context.get(), system.wkt);
  double west = 0;
  double south = 0;
  double east = 0;
  double north = 0;
  if (!parsed || proj_get_area_of_use(context.get(), parsed.get(), &west, &south, &east, &north, nullptr) == 0 ||
      west < -180) {  // PROJ states -1000 for unknown
    return true;
  }
  const geometry::Box degrees = proj::degrees_of(system, bounds);
  if (degrees.empty()) return system.kind == SystemKind::kOther;
  const glm::dvec3 middle = (degrees.min + degrees.max) * 0.5;
  const bool longitude = west <= east ? middle.x >= west && middle.x <= east : middle.x >= west || middle.x <= east;
  return longitude && middle.y >= south && middle.y <= north;
}

}  // namespace surfcast::crs::proj
