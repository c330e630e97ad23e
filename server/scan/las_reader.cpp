#include "scan/las_reader.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "scan/las_header.h"
#include "scan/las_records.h"

namespace surfcast {
namespace {

template <typename T, typename Value>
std::vector<T> gather(const LasRecords& records, const Value& value_of) {
  std::vector<T> values;
  values.reserve(records.count);
  for (const std::span<const std::byte> run : records.runs) {
    for (size_t at = 0; at < run.size(); at += records.stride) values.push_back(value_of(&run[at]));
  }
  return values;
}

/// Keeps an attribute unless it is zero everywhere.
template <typename T>
void keep_if_recorded(ScanPoints& points, std::string name, std::vector<T> values) {
  const bool recorded = std::any_of(values.begin(), values.end(), [](T v) { return v != T{0}; });
  if (recorded) points.scalars.push_back({std::move(name), std::move(values)});
}

template <typename T>
void read_field(const LasRecords& records, size_t offset, std::string name, ScanPoints& points) {
  keep_if_recorded(points, std::move(name),
                   gather<T>(records, [offset](const std::byte* at) { return load<T>(at + offset); }));
}

/// Part of a byte: `(byte >> shift) & mask`.
void read_bits(const LasRecords& records, size_t offset, int shift, int mask, std::string name, ScanPoints& points) {
  keep_if_recorded(points, std::move(name), gather<uint8_t>(records, [=](const std::byte* at) {
                     return static_cast<uint8_t>((std::to_integer<int>(at[offset]) >> shift) & mask);
                   }));
}

std::vector<glm::dvec3> read_positions(const LasRecords& records, const Grid& grid) {
  return gather<glm::dvec3>(records, [&grid](const std::byte* at) {
    return grid.position({load<int32_t>(at), load<int32_t>(at + 4), load<int32_t>(at + 8)});
  });
}

std::optional<ColorAttribute> read_colors(const LasRecords& records, size_t offset) {
  ColorAttribute colors;
  colors.values = gather<glm::u16vec3>(records, [offset](const std::byte* at) {
    return glm::u16vec3(load<uint16_t>(at + offset), load<uint16_t>(at + offset + 2), load<uint16_t>(at + offset + 4));
  });
  int largest = 0;
  for (const glm::u16vec3& c : colors.values) largest = std::max<int>({largest, c.x, c.y, c.z});
  if (largest == 0) return std::nullopt;
  colors.bits = largest <= 255 ? 8 : 16;
  return colors;
}

/// Point formats 0 to 5 (LAS 1.4, table 7).
void read_legacy_core(const LasRecords& records, ScanPoints& points) {
  read_field<uint16_t>(records, 12, "intensity", points);
  read_bits(records, 14, 0, 7, "return_number", points);
  read_bits(records, 14, 3, 7, "number_of_returns", points);
  read_bits(records, 14, 6, 1, "scan_direction_flag", points);
  read_bits(records, 14, 7, 1, "edge_of_flight_line", points);
  read_bits(records, 15, 0, 31, "classification", points);
  read_bits(records, 15, 5, 7, "classification_flags", points);
  read_field<int8_t>(records, 16, "scan_angle_rank", points);
  read_field<uint8_t>(records, 17, "user_data", points);
  read_field<uint16_t>(records, 18, "point_source_id", points);
}

/// Point formats 6 to 10 (LAS 1.4, table 15).
void read_core(const LasRecords& records, ScanPoints& points) {
  read_field<uint16_t>(records, 12, "intensity", points);
  read_bits(records, 14, 0, 15, "return_number", points);
  read_bits(records, 14, 4, 15, "number_of_returns", points);
  read_bits(records, 15, 0, 15, "classification_flags", points);
  read_bits(records, 15, 4, 3, "scanner_channel", points);
  read_bits(records, 15, 6, 1, "scan_direction_flag", points);
  read_bits(records, 15, 7, 1, "edge_of_flight_line", points);
  read_field<uint8_t>(records, 16, "classification", points);
  read_field<uint8_t>(records, 17, "user_data", points);
  read_field<int16_t>(records, 18, "scan_angle", points);
  read_field<uint16_t>(records, 20, "point_source_id", points);
}

/// Where a point format holds what only some formats have; 0: not at all.
struct OptionalOffsets {
  size_t gps_time;
  size_t color;
  size_t nir;
};

constexpr OptionalOffsets kOptionalOffsets[] = {{0, 0, 0},    {20, 0, 0},  {0, 20, 0},  {20, 28, 0},
                                                {20, 0, 0},   {20, 28, 0}, {22, 0, 0},  {22, 30, 0},
                                                {22, 30, 36}, {22, 0, 0},  {22, 30, 36}};

/// The name that the file gives, with a number behind it where another attribute has that name.
std::string unused_name(const ScanPoints& points, const std::string& wanted) {
  const auto taken = [&points](const std::string& name) {
    return std::any_of(points.scalars.begin(), points.scalars.end(),
                       [&name](const ScalarAttribute& scalar) { return scalar.name == name; });
  };
  std::string name = wanted;
  for (int suffix = 2; name.empty() || taken(name); ++suffix) name = wanted + "_" + std::to_string(suffix);
  return name;
}

void read_extra_field(const LasRecords& records, const LasExtraField& field, ScanPoints& points) {
  const std::string name = unused_name(points, field.name);
  if (field.scale != 1 || field.shift != 0) {
    std::vector<double> values = with_type(field.type, [&](auto zero) {
      return gather<double>(records, [&](const std::byte* at) {
        return static_cast<double>(load<decltype(zero)>(at + field.offset)) * field.scale + field.shift;
      });
    });
    points.scalars.push_back({name, std::move(values)});
    return;
  }
  with_type(field.type, [&](auto zero) {
    using T = decltype(zero);
    points.scalars.push_back(
        {name, gather<T>(records, [&](const std::byte* at) { return load<T>(at + field.offset); })});
  });
}

}  // namespace

Result<ScanPoints> read_las(std::span<const std::byte> bytes) {
  const Result<LasHeader> header = parse_las_header(bytes);
  if (!header) return fail(header.error());
  const Result<LasRecords> found = las_records(bytes, *header);
  if (!found) return fail(found.error());
  const LasRecords& records = *found;
  ScanPoints points;
  points.positions = read_positions(records, header->grid);
  points.grid = header->grid;
  header->point_format < 6 ? read_legacy_core(records, points) : read_core(records, points);
  const OptionalOffsets& offsets = kOptionalOffsets[header->point_format];
  if (offsets.gps_time != 0) read_field<double>(records, offsets.gps_time, "gps_time", points);
  if (offsets.color != 0) points.colors = read_colors(records, offsets.color);
  if (offsets.nir != 0) read_field<uint16_t>(records, offsets.nir, "nir", points);
  for (const LasExtraField& field : header->extra_fields) read_extra_field(records, field, points);
  return points;
}

}  // namespace surfcast
