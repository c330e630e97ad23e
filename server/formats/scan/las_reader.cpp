#include "scan/las_reader.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "scan/laz_rows.h"

namespace surfcast::scan {
namespace {

constexpr auto kU8 = ScalarType::kUint8;
constexpr auto kU16 = ScalarType::kUint16;

/// Point formats 0 to 5 (LAS 1.4, table 7).
constexpr LasField kLegacyCore[] = {{"intensity", 12, kU16},
                                    {"return_number", 14, kU8, 0, 7},
                                    {"number_of_returns", 14, kU8, 3, 7},
                                    {"scan_direction_flag", 14, kU8, 6, 1},
                                    {"edge_of_flight_line", 14, kU8, 7, 1},
                                    {"classification", 15, kU8, 0, 31},
                                    {"classification_flags", 15, kU8, 5, 7},
                                    {"scan_angle_rank", 16, ScalarType::kInt8},
                                    {"user_data", 17, kU8},
                                    {"point_source_id", 18, kU16}};

/// Point formats 6 to 10 (LAS 1.4, table 15).
constexpr LasField kCore[] = {{"intensity", 12, kU16},
                              {"return_number", 14, kU8, 0, 15},
                              {"number_of_returns", 14, kU8, 4, 15},
                              {"classification_flags", 15, kU8, 0, 15},
                              {"scanner_channel", 15, kU8, 4, 3},
                              {"scan_direction_flag", 15, kU8, 6, 1},
                              {"edge_of_flight_line", 15, kU8, 7, 1},
                              {"classification", 16, kU8},
                              {"user_data", 17, kU8},
                              {"scan_angle", 18, ScalarType::kInt16},
                              {"point_source_id", 20, kU16}};

/// Offsets of fields that only some point formats have; 0: absent.
struct OptionalOffsets {
  size_t gps_time;
  size_t color;
  size_t nir;
  size_t wave_packet;
};

/// Relative to the start of the wave packet (LAS 1.4, table 12).
constexpr LasField kWavePacket[] = {{"wave_packet_index", 0, kU8},
                                    {"wave_packet_offset", 1, ScalarType::kUint64},
                                    {"wave_packet_size", 9, ScalarType::kUint32},
                                    {"wave_return_location", 13, ScalarType::kFloat32},
                                    {"wave_dx", 17, ScalarType::kFloat32},
                                    {"wave_dy", 21, ScalarType::kFloat32},
                                    {"wave_dz", 25, ScalarType::kFloat32}};

constexpr OptionalOffsets kOptionalOffsets[] = {{0, 0, 0, 0},    {20, 0, 0, 0},   {0, 20, 0, 0},   {20, 28, 0, 0},
                                                {20, 0, 0, 28},  {20, 28, 0, 34}, {22, 0, 0, 0},   {22, 30, 0, 0},
                                                {22, 30, 36, 0}, {22, 0, 0, 30},  {22, 30, 36, 38}};

/// Coordinates along one axis, computed as in Grid::position.
std::vector<double> coordinates(const std::byte* at, size_t count, size_t stride, double scale, double offset) {
  std::vector<double> values(count);
  for (size_t i = 0; i < count; ++i, at += stride) values[i] = static_cast<double>(load<int32_t>(at)) * scale + offset;
  return values;
}

void add_field(const LasField& field, const std::byte* records, size_t stride, PointTable& table) {
  const std::byte* at = records + field.offset;
  if (field.mask == 0) {
    table.columns.push_back({field.type, at, stride, false});
    return;
  }
  std::vector<uint8_t> values(table.rows);
  for (size_t i = 0; i < table.rows; ++i, at += stride) {
    values[i] = static_cast<uint8_t>((std::to_integer<int>(*at) >> field.shift) & field.mask);
  }
  add_column(table, std::move(values));
}

bool is_scaled(const LasExtraField& field) {
  return field.scale != 1 || field.shift != 0;
}

void add_extra_field(const LasExtraField& field, const std::byte* records, size_t stride, PointTable& table) {
  const Column stored = {field.type, records + field.offset, stride, false};
  if (!is_scaled(field)) {
    table.columns.push_back(stored);
    return;
  }
  std::vector<double> values(table.rows);
  for_each_value(stored, table.rows,
                 [&](size_t i, auto value) { values[i] = static_cast<double>(value) * field.scale + field.shift; });
  add_column(table, std::move(values));
}

/// The records of an uncompressed file, read in place.
class LasRows : public RowSource {
 public:
  LasRows(std::span<const std::byte> bytes, LasHeader header)
      : first_(bytes.data() + header.data_offset),
        header_(std::move(header)),
        traits_(las_traits(header_)),
        columns_(las_columns(header_)) {}

  [[nodiscard]] const RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return (header_.count + kPieceRows - 1) / kPieceRows; }
  [[nodiscard]] Result<PointTable> read(size_t piece) const override {
    const uint64_t first = piece * kPieceRows;
    return las_table(first_ + first * header_.record_length, std::min(kPieceRows, header_.count - first), header_);
  }

 private:
  const std::byte* first_;
  LasHeader header_;
  RowTraits traits_;
  std::vector<ColumnInfo> columns_;
};

}  // namespace

std::vector<LasField> las_fields(int point_format) {
  std::vector<LasField> fields;
  if (point_format < 6) fields.assign(std::begin(kLegacyCore), std::end(kLegacyCore));
  if (point_format >= 6) fields.assign(std::begin(kCore), std::end(kCore));
  const OptionalOffsets& offsets = kOptionalOffsets[point_format];
  if (offsets.gps_time != 0) fields.push_back({"gps_time", offsets.gps_time, ScalarType::kFloat64});
  if (offsets.color != 0) {
    fields.push_back({"red", offsets.color, kU16});
    fields.push_back({"green", offsets.color + 2, kU16});
    fields.push_back({"blue", offsets.color + 4, kU16});
  }
  if (offsets.nir != 0) fields.push_back({"nir", offsets.nir, kU16});
  if (offsets.wave_packet == 0) return fields;
  for (LasField field : kWavePacket) {
    field.offset += offsets.wave_packet;
    fields.push_back(field);
  }
  return fields;
}

RowTraits las_traits(const LasHeader& header) {
  RowTraits traits;
  traits.grid = header.grid;
  traits.crs = header.crs;
  if (kOptionalOffsets[header.point_format].wave_packet != 0) {
    traits.notes.emplace_back("the samples of its waveforms are not read");
  }
  return traits;
}

std::vector<ColumnInfo> las_columns(const LasHeader& header) {
  std::vector<ColumnInfo> columns;
  for (const char* axis : {"x", "y", "z"}) columns.push_back({axis, ScalarType::kFloat64, false});
  for (const LasField& field : las_fields(header.point_format)) columns.push_back({field.name, field.type, true});
  for (const LasExtraField& field : header.extra_fields) {
    columns.push_back({field.name, is_scaled(field) ? ScalarType::kFloat64 : field.type, false});
  }
  return columns;
}

PointTable las_table(const std::byte* records, size_t count, const LasHeader& header) {
  const size_t stride = header.record_length;
  PointTable table;
  table.rows = count;
  table.las_records = records;
  for (int axis = 0; axis < 3; ++axis) {
    const std::byte* first = records + sizeof(int32_t) * static_cast<size_t>(axis);
    add_column(table, coordinates(first, count, stride, header.grid.scale[axis], header.grid.offset[axis]));
  }
  for (const LasField& field : las_fields(header.point_format)) add_field(field, records, stride, table);
  for (const LasExtraField& field : header.extra_fields) add_extra_field(field, records, stride, table);
  return table;
}

Result<std::unique_ptr<RowSource>> las_rows(std::span<const std::byte> bytes, const Selection& selection) {
  Result<LasHeader> header = parse_las_header(bytes);
  if (!header) return fail(header);
  if (header->compressed) return laz_rows(bytes, std::move(*header), selection);
  return std::make_unique<LasRows>(bytes, std::move(*header));
}

}  // namespace surfcast::scan
