#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "geometry/box.h"

namespace surfcast::crs {

enum class SystemKind {
  kProjected,   ///< x east, y north, lengths
  kGeographic,  ///< x longitude, y latitude, degrees
  kGeocentric,  ///< earth-centred, earth-fixed (ECEF)
  kOther,       ///< local or unknown: nothing leads to another system
};

/// A coordinate reference system. Coordinates are in the order that drawing programs expect, whatever order the system
/// states: longitude or easting first.
struct CoordinateSystem {
  std::string name;  ///< "ETRS89 / UTM zone 32N"
  std::string id;    ///< "EPSG:25832"; empty if no authority has it
  std::string wkt;   ///< WKT 2 (ISO 19162:2019), one line
  SystemKind kind = SystemKind::kOther;
  double unit = 1;         ///< metres of a unit of x and y; 1 for degrees
  double height_unit = 1;  ///< metres of a unit of z. A system that states none has the unit of x and y, or metres
  bool heights = false;    ///< the system states what z is

  /// The same length is the same number along all axes.
  [[nodiscard]] bool is_metric() const {
    return kind == SystemKind::kOther || (kind == SystemKind::kProjected && unit == height_unit);
  }
};

/// Reads WKT (1, 2 or ESRI's) or the code of an authority ("EPSG:25832", with a vertical system "EPSG:25832+7837").
///
/// GeoKeys may state other units than their systems have. They are written as "EPSG:26918@9003+5703@9002": after each
/// code that of its unit of length, by EPSG; 0: the system's own. A vertical system that has the unit of the horizontal
/// one is left out, and one that PROJ does not know, or of code 0, is a height of that unit over nothing known.
///
/// Errors are one line and do not name a file.
Result<CoordinateSystem> read_system(std::string_view text);

/// True if coordinates mean the same in both.
[[nodiscard]] bool are_same(const CoordinateSystem& a, const CoordinateSystem& b);

/// A system in which points can be drawn: `system` itself if it is metric. Degrees and geocentric coordinates become
/// the UTM zone of the middle of `degrees`, which is where the points lie (degrees_of), on the same datum, beyond the
/// latitudes of UTM too. Of projected systems with another unit for heights, the projected part.
Result<CoordinateSystem> metric_system(const CoordinateSystem& system, const geometry::Box& degrees);

/// Where a box lies, in degrees of WGS 84: x is the longitude, y the latitude, z is 0. Empty if that is unknown, or
/// farther than 1000 km from the surface of the earth.
[[nodiscard]] geometry::Box degrees_of(const CoordinateSystem& system, const geometry::Box& bounds);

/// False if the middle of the box lies outside the area that the system is made for.
[[nodiscard]] bool is_in_area_of_use(const CoordinateSystem& system, const geometry::Box& bounds);

}  // namespace surfcast::crs
