#include "exporter/las_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <set>
#include <string_view>
#include <utility>

#include "crs/coordinate_system.h"
#include "exporter/las_bytes.h"
#include "exporter/table_format.h"

namespace surfcast::exporter {
namespace {

using Bytes = std::vector<std::byte>;
using scan::ScalarType;
using scan::ScanSchema;

constexpr size_t kHeader12 = 227;
constexpr size_t kHeader14 = 375;
constexpr double kLargestIndex = 2147483647.0;  // of 32 bits

bool has(const ScanSchema& schema, std::initializer_list<std::string_view> names) {
  return std::any_of(schema.scalars.begin(), schema.scalars.end(), [&](const scan::ScalarField& field) {
    return std::find(names.begin(), names.end(), field.name) != names.end();
  });
}

/// Fields that point formats 0 to 5 lack, or have too few bits for.
bool needs_new_format(const ScanSchema& schema) {
  return has(schema, {"classification", "classification_flags", "return_number", "number_of_returns", "scanner_channel",
                      "scan_angle", "nir"});
}

int point_format_of(const LasPoints& points) {
  const ScanSchema& schema = *points.schema;
  const bool color = schema.color_bits != 0;
  if (points.modern || needs_new_format(schema) || points.count > UINT32_MAX)
    return has(schema, {"nir"}) ? 8 : color ? 7 : 6;
  return (has(schema, {"gps_time"}) ? 1 : 0) + (color ? 2 : 0);
}

/// Whether all values of the type are values of the field.
bool fits(ScalarType type, ScalarType field) {
  if (type == field) return true;
  if (field == ScalarType::kUint16) return type == ScalarType::kUint8;
  if (field == ScalarType::kInt16) return type == ScalarType::kUint8 || type == ScalarType::kInt8;
  return field == ScalarType::kFloat64 && type != ScalarType::kUint64 && type != ScalarType::kInt64;
}

struct ExtraBytes {
  Bytes entries;  ///< of the record that declares them (LAS 1.4, table 24)
  size_t length;  ///< of a record so far

  size_t add(std::string_view name, ScalarType type) {
    Bytes entry(192);
    put(entry, 2, static_cast<uint8_t>(static_cast<int>(type) + 1));
    put_text(entry, 4, name.substr(0, 32));
    add_bytes(entries, entry);
    length += scan::size_of(type);
    return length - scan::size_of(type);
  }
};

void place_attributes(const ScanSchema& schema, LasTable& table, ExtraBytes& extra) {
  const std::vector<scan::LasField> fields = scan::las_fields(table.head.point_format);
  for (const scan::LasField& field : fields) {
    if (field.name == std::string_view("red") && schema.color_bits != 0) table.color_offset = field.offset;
  }
  table.color_factor = schema.color_bits == 8 ? 257 : 1;
  for (size_t i = 0; i < schema.scalars.size(); ++i) {
    const scan::ScalarField& scalar = schema.scalars[i];
    const auto place = std::find_if(fields.begin(), fields.end(), [&scalar](const scan::LasField& field) {
      return field.name == scalar.name && fits(scalar.type, field.type);
    });
    if (place != fields.end()) {
      table.places.push_back({i, *place});
    } else {
      const size_t offset = extra.add(scalar.name, scalar.type);
      table.places.push_back({i, {"", offset, scalar.type}});
    }
  }
  if (schema.normals) {
    table.normal_offset = extra.add("NormalX", ScalarType::kFloat32);
    extra.add("NormalY", ScalarType::kFloat32);
    extra.add("NormalZ", ScalarType::kFloat32);
  }
  if (schema.radii) table.radius_offset = extra.add("Radius", ScalarType::kFloat32);
}

/// GeoKeys (OGC 19-008r4) of the code of a geographic or projected system.
Bytes geo_keys(uint16_t code, bool geographic) {
  Bytes keys;
  const auto add_key = [&keys](uint16_t key, uint16_t place, uint16_t count, uint16_t value) {
    for (const uint16_t number : std::to_array<uint16_t>({key, place, count, value})) add(keys, number);
  };
  add_key(1, 1, 0, 2);  // version 1.1.0, two keys
  add_key(1024, 0, 1, geographic ? 2 : 1);
  add_key(geographic ? 2048 : 3072, 0, 1, code);
  return keys;
}

std::optional<uint16_t> epsg_code(std::string_view crs) {
  constexpr std::string_view kPrefix = "EPSG:";
  uint16_t code = 0;
  if (!crs.starts_with(kPrefix)) return std::nullopt;
  const auto [end, error] = std::from_chars(crs.data() + kPrefix.size(), crs.data() + crs.size(), code);
  if (error != std::errc() || end != crs.data() + crs.size()) return std::nullopt;
  return code;
}

/// Returns whether the system is stated as WKT, as it always is with point formats from 6 on. With others codes have
/// GeoKeys, which more programs read, if LAS knows keys for their kind. Texts that are no WKT are left out: LAS has no
/// place for them.
bool add_system(const std::string& text, LasHead& head) {
  const auto code = epsg_code(text);
  Result<crs::CoordinateSystem> system = fail(ErrorKind::kInvalidInput, "not a code of EPSG");
  if (code) system = crs::read_system(text);
  const bool geographic = system && system->kind == crs::SystemKind::kGeographic;
  const bool has_key = geographic || (system && system->kind == crs::SystemKind::kProjected);
  if (has_key && head.point_format < 6) {
    head.records.push_back(las_record("LASF_Projection", 34735, geo_keys(*code, geographic)));
    return false;
  }
  const std::string& wkt = system ? system->wkt : text;
  if (wkt.find('[') == std::string::npos || wkt.size() >= UINT16_MAX) return false;
  head.records.push_back(wkt_record(wkt));
  return true;
}

Bytes header_of(const LasTable& table, bool new_version, bool wkt) {
  Bytes header(new_version ? kHeader14 : kHeader12);
  put_text(header, 0, "LASF");
  put(header, 6, static_cast<uint16_t>(wkt ? 16 : 0));
  put(header, 24, uint8_t{1});
  put(header, 25, static_cast<uint8_t>(new_version ? 4 : 2));
  put_text(header, 58, "Surfcast");
  put(header, 94, static_cast<uint16_t>(header.size()));
  for (int axis = 0; axis < 3; ++axis) {
    put(header, 131 + 8 * static_cast<size_t>(axis), table.grid.scale[axis]);
    put(header, 155 + 8 * static_cast<size_t>(axis), table.grid.offset[axis]);
  }
  return header;
}

/// A power of ten as its literal reads.
double power_of_ten(double exponent) {
  return exponent < 0 ? 1 / std::pow(10.0, -exponent) : std::pow(10.0, exponent);
}

double scale_for(const geometry::Box& bounds) {
  const glm::dvec3 size = bounds.size();
  const double extent = std::max({size.x, size.y, size.z});
  const glm::dvec3 farthest = glm::max(glm::abs(bounds.min), glm::abs(bounds.max));
  const double precision = std::max({farthest.x, farthest.y, farthest.z}) * std::numeric_limits<double>::epsilon();
  const double finest = std::max(extent * 0x1p-24, precision);
  if (finest == 0) return 0.001;
  const double fine = power_of_ten(std::ceil(std::log10(finest)));
  return std::max(std::min(fine, 0.001), power_of_ten(std::ceil(std::log10(std::max(precision, extent * 0x1p-30)))));
}

bool spans(const surfel::Grid& grid, const geometry::Box& bounds) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double end : {bounds.min[axis], bounds.max[axis]}) {
      if (!(std::abs((end - grid.offset[axis]) / grid.scale[axis]) <= kLargestIndex)) return false;
    }
  }
  return true;
}

Result<surfel::Grid> grid_of(const LasPoints& points) {
  const ScanSchema& schema = *points.schema;
  if (points.bounds.empty()) return fail(ErrorKind::kInvalidInput, schema.name + ": no point has coordinates");
  if (schema.grid && !points.scale && spans(*schema.grid, points.bounds)) return *schema.grid;
  const surfel::Grid grid = lattice_for(points.bounds, points.scale);
  if (spans(grid, points.bounds)) return grid;
  return fail(ErrorKind::kLimit,
              schema.name + ": too wide for coordinates of 32 bits in steps of " + shortest(grid.scale.x));
}

/// Numbers of bits that a mask has no room for.
tl::unexpected<Error> too_large(const LasPlace& place, double value) {
  return fail(ErrorKind::kInvalidInput, std::string(place.field.name) + " " + shortest(value) +
                                            " does not fit into LAS, which has room for values up to " +
                                            std::to_string(place.field.mask));
}

class RecordMaker {
 public:
  RecordMaker(const scan::ScanPoints& points, const LasTable& table) : points_(points), table_(table) {
    for (size_t i = 0; i < points.size(); ++i) {
      const glm::dvec3& p = points.positions[i];
      if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) rows_.push_back(i);
    }
    bytes_.resize(rows_.size() * table.head.record_length);
  }

  Result<Bytes> make() {
    for (size_t i = 0; i < rows_.size(); ++i) put_fixed(i);
    for (const LasPlace& place : table_.places) {
      if (Status status = put_attribute(place); !status) return fail(status);
    }
    return std::move(bytes_);
  }

 private:
  void put_fixed(size_t i) {
    const size_t at = i * table_.head.record_length;
    const glm::i64vec3 index = table_.grid.index(points_.positions[rows_[i]]);
    for (int axis = 0; axis < 3; ++axis)
      put(bytes_, at + 4 * static_cast<size_t>(axis), static_cast<int32_t>(index[axis]));
    for (int channel = 0; channel < 3; ++channel) {
      const auto step = static_cast<size_t>(channel);
      if (table_.color_offset != 0) {
        const int color = points_.colors->values[rows_[i]][channel] * table_.color_factor;
        put(bytes_, at + table_.color_offset + 2 * step, static_cast<uint16_t>(color));
      }
      if (table_.normal_offset != 0)
        put(bytes_, at + table_.normal_offset + 4 * step, points_.normals[rows_[i]][channel]);
    }
    if (table_.radius_offset != 0) put(bytes_, at + table_.radius_offset, points_.radii[rows_[i]]);
  }

  Status put_attribute(const LasPlace& place) {
    return std::visit(
        [&](const auto& values) { return place.field.mask != 0 ? put_bits(place, values) : put_values(place, values); },
        points_.scalars[place.scalar].values);
  }

  template <typename T>
  Status put_bits(const LasPlace& place, const std::vector<T>& values) {
    for (size_t i = 0; i < rows_.size(); ++i) {
      const auto value = static_cast<double>(values[rows_[i]]);
      if (!(value >= 0 && value <= place.field.mask)) return too_large(place, value);
      bytes_[i * table_.head.record_length + place.field.offset] |=
          static_cast<std::byte>(static_cast<int>(value) << place.field.shift);
    }
    return {};
  }

  template <typename T>
  Status put_values(const LasPlace& place, const std::vector<T>& values) {
    scan::with_type(place.field.type, [&](auto zero) {
      for (size_t i = 0; i < rows_.size(); ++i) {
        put(bytes_, i * table_.head.record_length + place.field.offset, static_cast<decltype(zero)>(values[rows_[i]]));
      }
    });
    return {};
  }

  const scan::ScanPoints& points_;
  const LasTable& table_;
  std::vector<size_t> rows_;  ///< points with coordinates
  Bytes bytes_;
};

}  // namespace

surfel::Grid lattice_for(const geometry::Box& bounds, std::optional<double> scale) {
  surfel::Grid grid;
  grid.scale = glm::dvec3(scale.value_or(scale_for(bounds)));
  // Round numbers near the points, so that the numbers of 32 bits suffice for what lies far from the origin.
  const double wide = grid.scale.x * 1e8;
  const double step = wide >= 1 ? std::round(wide) : wide;
  for (int axis = 0; axis < 3; ++axis) grid.offset[axis] = std::floor(bounds.min[axis] / step) * step;
  return grid;
}

Result<LasTable> plan_las_table(const LasPoints& points) {
  const ScanSchema& schema = *points.schema;
  const Result<surfel::Grid> grid = grid_of(points);
  if (!grid) return fail(grid);
  LasTable table;
  table.grid = *grid;
  table.head.compressed = points.compressed;
  table.head.point_format = point_format_of(points);
  ExtraBytes extra{{}, scan::las_record_length(table.head.point_format)};
  place_attributes(schema, table, extra);
  if (extra.length > UINT16_MAX || extra.entries.size() > UINT16_MAX)
    return fail(ErrorKind::kLimit, schema.name + ": has more attributes than LAS can hold");
  table.head.record_length = extra.length;
  if (!extra.entries.empty()) table.head.records.push_back(las_record("LASF_Spec", 4, extra.entries));
  const bool wkt = add_system(schema.crs, table.head);
  const bool modern = table.head.point_format >= 6;  // these set the bit of WKT even where no system is stated
  table.head.header = header_of(table, wkt || modern, wkt || modern);
  return table;
}

Result<std::vector<std::byte>> las_records_of(const scan::ScanPoints& points, const LasTable& table) {
  return RecordMaker(points, table).make();
}

}  // namespace surfcast::exporter
