#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/ascii_text.h"
#include "scan/e57_header.h"
#include "scan/e57_pages.h"
#include "scan/e57_streams.h"
#include "scan/readers.h"

namespace surfcast::scan {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Bits `at` to `at + width` - 1, the least significant first.
uint64_t bits_at(const std::vector<std::byte>& bytes, uint64_t at, int width) {
  const std::byte* first = &bytes[at / 8];
  const auto shift = static_cast<int>(at % 8);
  const uint64_t low = load<uint64_t>(first) >> shift;
  const uint64_t high = shift == 0 ? 0 : std::to_integer<uint64_t>(first[8]) << (64 - shift);
  return (low | high) & (width == 64 ? ~uint64_t{0} : (uint64_t{1} << width) - 1);
}

/// The integers of a field.
std::vector<int64_t> integers_of(const E57Field& field, const std::vector<std::byte>& bytes, uint64_t first,
                                 uint64_t count) {
  std::vector<int64_t> values(count, field.minimum);
  if (field.bits == 0) return values;
  const auto width = static_cast<uint64_t>(field.bits);
  uint64_t at = first * width % 8;
  for (int64_t& value : values) {
    value = static_cast<int64_t>(static_cast<uint64_t>(field.minimum) + bits_at(bytes, at, field.bits));
    at += width;
  }
  return values;
}

/// A run of points of one scan.
struct Run {
  size_t scan = 0;
  uint64_t first = 0;
  uint64_t count = 0;
};

/// Names of values by camel case become words with underscores; a prefix of an extension is left out.
std::string attribute_name(std::string_view field) {
  field.remove_prefix(std::min(field.find(':') + 1, field.size()));
  std::string name;
  for (const char c : field) {
    if (std::isupper(static_cast<unsigned char>(c)) != 0 && !name.empty()) name += '_';
    name += to_lower(c);
  }
  return name;
}

/// Fields that make up positions and colours.
bool is_geometry(std::string_view name) {
  static const std::set<std::string_view> kNames{
      "cartesianX",     "cartesianY",       "cartesianZ",         "cartesianInvalidState",
      "sphericalRange", "sphericalAzimuth", "sphericalElevation", "sphericalInvalidState",
      "colorRed",       "colorGreen",       "colorBlue"};
  return kNames.contains(name);
}

ScalarType type_of_field(const E57Field& field) {
  if (field.coding == E57Coding::kFloat) return ScalarType::kFloat32;
  if (field.coding != E57Coding::kInteger) return ScalarType::kFloat64;
  const auto fits = [&field](int64_t low, int64_t high) { return field.minimum >= low && field.maximum <= high; };
  if (fits(0, 255)) return ScalarType::kUint8;
  if (fits(0, 65535)) return ScalarType::kUint16;
  if (fits(std::numeric_limits<int32_t>::min(), std::numeric_limits<int32_t>::max())) return ScalarType::kInt32;
  return ScalarType::kInt64;
}

/// A value beside position and colour, of all scans together.
struct Attribute {
  std::string field;
  ScalarType type;
};

std::vector<Attribute> attributes_of(const std::vector<E57Scan>& scans) {
  std::vector<Attribute> all;
  for (const E57Scan& scan : scans) {
    for (const E57Field& field : scan.fields) {
      if (field.coding == E57Coding::kString || is_geometry(field.name)) continue;
      const ScalarType type = type_of_field(field);
      const auto same =
          std::find_if(all.begin(), all.end(), [&field](const Attribute& a) { return a.field == field.name; });
      if (same == all.end()) {
        all.push_back({field.name, type});
      } else if (same->type != type) {
        same->type = ScalarType::kFloat64;
      }
    }
  }
  return all;
}

bool has_colors(const E57Scan& scan) {
  return scan.field("colorRed") && scan.field("colorGreen") && scan.field("colorBlue");
}

/// 0 without colour, else 8 or 16.
int color_bits(const std::vector<E57Scan>& scans) {
  int bits = 0;
  for (const E57Scan& scan : scans) {
    if (has_colors(scan)) bits = std::max(bits, scan.color_limits.second > 255 ? 16 : 8);
  }
  return bits;
}

bool has_positions(const E57Scan& scan) {
  const bool cartesian = scan.field("cartesianX") && scan.field("cartesianY") && scan.field("cartesianZ");
  const bool spherical =
      scan.field("sphericalRange") && scan.field("sphericalAzimuth") && scan.field("sphericalElevation");
  return cartesian || spherical;
}

/// Points whose positions take no bytes could be of any number.
bool positions_take_bytes(const E57Scan& scan) {
  return std::any_of(scan.fields.begin(), scan.fields.end(), [](const E57Field& field) {
    return is_geometry(field.name) && field.coding != E57Coding::kString && field.bits > 0;
  });
}

class E57Rows : public RowSource {
 public:
  E57Rows(const E57Pages& pages, E57Header header, std::vector<E57Streams> streams)
      : pages_(pages),
        scans_(std::move(header.scans)),
        streams_(std::move(streams)),
        attributes_(attributes_of(scans_)),
        color_bits_(color_bits(scans_)) {
    traits_.crs = std::move(header.crs);
    if (header.images > 0) traits_.notes.push_back("its " + std::to_string(header.images) + " images are not read");
    if (scans_.size() == 1 && scans_[0].pose) traits_.sensor = scans_[0].pose->translation;
    add_columns();
    for (size_t scan = 0; scan < scans_.size(); ++scan) {
      for (uint64_t first = 0; first < scans_[scan].count; first += kPieceRows) {
        runs_.push_back({scan, first, std::min(kPieceRows, scans_[scan].count - first)});
      }
    }
  }

  [[nodiscard]] const RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return runs_.size(); }
  [[nodiscard]] Result<PointTable> read(size_t piece) const override {
    const Run& run = runs_[piece];
    PointTable table;
    table.rows = run.count;
    if (Status status = add_positions(run, table); !status) return fail(status);
    for (const char* channel : {"colorRed", "colorGreen", "colorBlue"}) {
      if (Status status = color_bits_ > 0 ? add_color(run, channel, table) : Status(); !status) {
        return fail(status);
      }
    }
    for (const Attribute& attribute : attributes_) {
      if (Status status = add_attribute(run, attribute, table); !status) return fail(status);
    }
    return table;
  }

 private:
  void add_columns() {
    for (const char* axis : {"x", "y", "z"}) columns_.push_back({axis, ScalarType::kFloat64, false});
    const ScalarType color = color_bits_ == 8 ? ScalarType::kUint8 : ScalarType::kUint16;
    for (const char* channel : {"red", "green", "blue"}) {
      if (color_bits_ > 0) columns_.push_back({channel, color, false});
    }
    for (const Attribute& attribute : attributes_) {
      columns_.push_back({attribute_name(attribute.field), attribute.type, false});
    }
  }

  [[nodiscard]] Result<std::vector<std::byte>> stream_of(const Run& run, size_t field) const {
    return streams_[run.scan].read(pages_, field, scans_[run.scan].fields[field].bits, run.first, run.count);
  }

  /// The values of a field; `otherwise` if the scan has no such field.
  [[nodiscard]] Result<std::vector<double>> values_of(const Run& run, std::string_view name, double otherwise) const {
    const std::optional<size_t> index = scans_[run.scan].field(name);
    std::vector<double> values(run.count, otherwise);
    if (!index) return values;
    const E57Field& field = scans_[run.scan].fields[*index];
    const Result<std::vector<std::byte>> bytes = stream_of(run, *index);
    if (!bytes) return fail(bytes);
    if (field.coding == E57Coding::kFloat || field.coding == E57Coding::kDouble) {
      const bool single = field.coding == E57Coding::kFloat;
      for (size_t i = 0; i < run.count; ++i) {
        values[i] = single ? double{load<float>(&(*bytes)[4 * i])} : load<double>(&(*bytes)[8 * i]);
      }
      return values;
    }
    const std::vector<int64_t> integers = integers_of(field, *bytes, run.first, run.count);
    for (size_t i = 0; i < run.count; ++i) {
      values[i] = static_cast<double>(integers[i]) * field.scale + field.offset;
    }
    return values;
  }

  using Triple = std::array<std::vector<double>, 3>;

  [[nodiscard]] Result<Triple> values_of(const Run& run, const std::array<const char*, 3>& names) const {
    Triple triple;
    for (size_t axis = 0; axis < 3; ++axis) {
      Result<std::vector<double>> values = values_of(run, names[axis], kNan);
      if (!values) return fail(values);
      triple[axis] = std::move(*values);
    }
    return triple;
  }

  /// Replaces the positions that are not valid by those of spherical coordinates, where these are.
  [[nodiscard]] Status use_spherical(const Run& run, const std::vector<double>& state, Triple& xyz) const {
    const Result<Triple> polar = values_of(run, {"sphericalRange", "sphericalAzimuth", "sphericalElevation"});
    if (!polar) return fail(polar);
    const Result<std::vector<double>> polar_state = values_of(run, "sphericalInvalidState", 0);
    if (!polar_state) return fail(polar_state);
    const auto& [range, azimuth, elevation] = *polar;
    for (size_t i = 0; i < run.count; ++i) {
      if (state[i] == 0) continue;
      const double r = (*polar_state)[i] == 0 ? range[i] : kNan;
      xyz[0][i] = r * std::cos(elevation[i]) * std::cos(azimuth[i]);
      xyz[1][i] = r * std::cos(elevation[i]) * std::sin(azimuth[i]);
      xyz[2][i] = r * std::sin(elevation[i]);
    }
    return {};
  }

  [[nodiscard]] Status add_positions(const Run& run, PointTable& table) const {
    const E57Scan& scan = scans_[run.scan];
    Result<Triple> xyz = values_of(run, {"cartesianX", "cartesianY", "cartesianZ"});
    if (!xyz) return fail(xyz);
    constexpr double kNotValid = 2;  // of both states
    const Result<std::vector<double>> state =
        values_of(run, "cartesianInvalidState", scan.field("cartesianX") ? 0 : kNotValid);
    if (!state) return fail(state);
    if (Status status = use_spherical(run, *state, *xyz); !status) return status;
    for (size_t i = 0; scan.pose && i < run.count; ++i) {
      const glm::dvec3 placed = scan.pose->apply({(*xyz)[0][i], (*xyz)[1][i], (*xyz)[2][i]});
      for (int axis = 0; axis < 3; ++axis) (*xyz)[static_cast<size_t>(axis)][i] = placed[axis];
    }
    for (std::vector<double>& values : *xyz) add_column(table, std::move(values));
    return {};
  }

  /// As numbers of the colour's bits: the limits become none and all of the colour.
  [[nodiscard]] Status add_color(const Run& run, const char* channel, PointTable& table) const {
    const auto [low, high] = scans_[run.scan].color_limits;
    const double top = color_bits_ == 8 ? 255 : 65535;
    const bool known = has_colors(scans_[run.scan]);
    const double grey = low + (high - low) / 2;
    const Result<std::vector<double>> values = values_of(run, known ? channel : "", grey);
    if (!values) return fail(values);
    std::vector<uint16_t> wide(run.count);
    for (size_t i = 0; i < run.count; ++i) {
      const double scaled = ((*values)[i] - low) / (high - low) * top + 0.5;
      wide[i] = static_cast<uint16_t>(scaled > 0 ? std::min(scaled, top) : 0.0);  // NaN becomes 0
    }
    if (color_bits_ == 16) {
      add_column(table, std::move(wide));
      return {};
    }
    std::vector<uint8_t> narrow(run.count);
    std::transform(wide.begin(), wide.end(), narrow.begin(),
                   [](uint16_t value) { return static_cast<uint8_t>(value); });
    add_column(table, std::move(narrow));
    return {};
  }

  [[nodiscard]] Status add_attribute(const Run& run, const Attribute& attribute, PointTable& table) const {
    const std::optional<size_t> index = scans_[run.scan].field(attribute.field);
    const bool whole = index && scans_[run.scan].fields[*index].coding == E57Coding::kInteger;
    if (!whole) {
      const Result<std::vector<double>> values = values_of(run, attribute.field, 0);
      if (!values) return fail(values);
      add_as(attribute.type, *values, table);
      return {};
    }
    const Result<std::vector<std::byte>> bytes = stream_of(run, *index);
    if (!bytes) return fail(bytes);
    add_as(attribute.type, integers_of(scans_[run.scan].fields[*index], *bytes, run.first, run.count), table);
    return {};
  }

  template <typename From>
  static void add_as(ScalarType type, const std::vector<From>& values, PointTable& table) {
    with_type(type, [&](auto zero) {
      using T = decltype(zero);
      std::vector<T> cast(values.size());
      std::transform(values.begin(), values.end(), cast.begin(), [](From value) { return static_cast<T>(value); });
      add_column(table, std::move(cast));
    });
  }

  E57Pages pages_;
  std::vector<E57Scan> scans_;
  std::vector<E57Streams> streams_;  ///< of each scan
  std::vector<Attribute> attributes_;
  int color_bits_;
  RowTraits traits_;
  std::vector<ColumnInfo> columns_;
  std::vector<Run> runs_;
};

}  // namespace

Result<std::unique_ptr<RowSource>> e57_rows(std::span<const std::byte> bytes) {
  const Result<E57Pages> pages = E57Pages::open(bytes);
  if (!pages) return fail(pages);
  Result<E57Header> header = parse_e57_header(*pages);
  if (!header) return fail(header);
  if (header->scans.empty()) return fail(ErrorKind::kInvalidInput, "has no points");
  std::vector<E57Streams> streams;
  for (const E57Scan& scan : header->scans) {
    if (!has_positions(scan)) return fail(ErrorKind::kInvalidInput, "has no coordinates for the points of a scan");
    if (!positions_take_bytes(scan)) {
      return fail(ErrorKind::kInvalidInput, "the points of an E57 scan are all in one place");
    }
    Result<E57Streams> opened = E57Streams::open(*pages, scan);
    if (!opened) return fail(opened);
    streams.push_back(std::move(*opened));
  }
  return std::make_unique<E57Rows>(*pages, std::move(*header), std::move(streams));
}

}  // namespace surfcast::scan
