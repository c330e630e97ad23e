#include "scan/las_header.h"

#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "base/invalid_input.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

using Bytes = std::span<const std::byte>;

// Offsets in the public header block: LAS 1.4 specification, table 3.
constexpr size_t kHeaderSize = 227;        // LAS 1.0 to 1.2, the smallest
constexpr size_t kHeaderSize14 = 375;      // the first fields of 1.5, too
constexpr size_t kRecordHeaderSize = 54;   // of a variable length record
constexpr uint8_t kCompressedBits = 0xC0;  // set in the point format by LASzip

uint64_t point_count(Bytes bytes, int minor_version) {
  const auto legacy = load<uint32_t>(&bytes[107]);
  if (minor_version < 4) return legacy;
  const auto count = load<uint64_t>(&bytes[247]);
  return count != 0 ? count : legacy;
}

bool usable_grid(const surfel::Grid& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(grid.scale[axis]) || grid.scale[axis] == 0 || !std::isfinite(grid.offset[axis])) return false;
  }
  return true;
}

Status check_sizes(Bytes bytes, const LasHeader& header) {
  if (header.data_offset < load<uint16_t>(&bytes[94]))
    return invalid_input("LAS points are said to begin in the header");
  if (header.data_offset > bytes.size())
    return invalid_input("truncated: the LAS points begin beyond the end of the file");
  if (header.record_length < las_record_length(header.point_format)) {
    return invalid_input("LAS point records of " + std::to_string(header.record_length) +
                         " bytes are too short for point format " + std::to_string(header.point_format));
  }
  if (header.compressed) return {};
  const uint64_t there = (bytes.size() - header.data_offset) / header.record_length;
  if (header.count > there) {
    return invalid_input("truncated: the header states " + std::to_string(header.count) + " points, the file holds " +
                         std::to_string(there));
  }
  return {};
}

/// The number type of an extra field. None for undocumented bytes and the deprecated arrays.
std::optional<ScalarType> extra_type(uint8_t code) {
  constexpr std::array kTypes = {ScalarType::kUint8,   ScalarType::kInt8,   ScalarType::kUint16, ScalarType::kInt16,
                                 ScalarType::kUint32,  ScalarType::kInt32,  ScalarType::kUint64, ScalarType::kInt64,
                                 ScalarType::kFloat32, ScalarType::kFloat64};
  if (code < 1 || code > kTypes.size()) return std::nullopt;
  return kTypes[code - 1U];
}

/// Bytes of an extra field in a record. Codes 11 to 20 and 21 to 30 are the deprecated pairs and triples.
size_t extra_size(uint8_t code, uint8_t options) {
  if (code == 0) return options;  // undocumented bytes
  if (code > 30) return 0;
  return size_of(*extra_type(static_cast<uint8_t>((code - 1) % 10 + 1))) * ((code - 1U) / 10 + 1);
}

LasExtraField describe_extra(Bytes entry, ScalarType type, size_t offset) {
  constexpr uint8_t kHasScale = 8;
  constexpr uint8_t kHasOffset = 16;
  const auto options = load<uint8_t>(&entry[3]);
  const std::string_view name = as_text(entry.subspan(4, 32));
  LasExtraField field{printable(name.substr(0, name.find('\0'))), type, offset, 1, 0};
  if (options & kHasScale) field.scale = load<double>(&entry[112]);
  if (options & kHasOffset) field.shift = load<double>(&entry[136]);
  return field;
}

/// Parses the body of the record that declares the extra fields: entries of 192 bytes.
void parse_extra_fields(Bytes body, LasHeader& header) {
  constexpr size_t kEntrySize = 192;
  size_t offset = las_record_length(header.point_format);
  for (; body.size() >= kEntrySize; body = body.subspan(kEntrySize)) {
    const auto code = load<uint8_t>(&body[2]);
    const size_t size = extra_size(code, load<uint8_t>(&body[3]));
    if (offset + size > header.record_length) return;
    if (const auto type = extra_type(code)) {
      header.extra_fields.push_back(describe_extra(body.first(kEntrySize), *type, offset));
    }
    offset += size;
  }
}

/// Calls `use` with the user ID, the record ID and the body of each variable length record. The stated number of
/// records is not trustworthy: the loop ends at the point data.
template <typename Use>
void for_each_variable_record(Bytes bytes, size_t data_offset, const Use& use) {
  const auto count = load<uint32_t>(&bytes[100]);
  size_t at = load<uint16_t>(&bytes[94]);
  for (uint32_t i = 0; i < count && at + kRecordHeaderSize <= data_offset; ++i) {
    const std::string_view user = as_text(bytes.subspan(at + 2, 16));
    const auto id = load<uint16_t>(&bytes[at + 18]);
    const auto length = load<uint16_t>(&bytes[at + 20]);
    at += kRecordHeaderSize;
    if (length > data_offset - at) return;
    use(user, id, bytes.subspan(at, length));
    at += length;
  }
}

/// A text without the padding behind it. Some writers store two quotes for no text.
std::string stored_text(Bytes body) {
  const std::string_view text = as_text(body);
  const std::string_view stored = text.substr(0, text.find('\0'));
  return stored == "\"\"" ? std::string() : std::string(stored);
}

/// What a GeoKey directory (OGC 19-008r4) states of the coordinate system: codes of EPSG; 0: nothing. Codes that other
/// records define count as none.
struct GeoKeys {
  uint16_t geographic = 0;     // 2048
  uint16_t projected = 0;      // 3072
  uint16_t unit = 0;           // 3076, of the projected system
  uint16_t vertical = 0;       // 4096
  uint16_t vertical_unit = 0;  // 4099
};

GeoKeys read_geo_keys(Bytes body) {
  constexpr uint16_t kUserDefined = 32767;
  GeoKeys keys;
  const std::array<std::pair<uint16_t, uint16_t*>, 5> wanted{{{2048, &keys.geographic},
                                                              {3072, &keys.projected},
                                                              {3076, &keys.unit},
                                                              {4096, &keys.vertical},
                                                              {4099, &keys.vertical_unit}}};
  for (size_t at = 8; at + 8 <= body.size(); at += 8) {  // behind the header: key, place, count, value
    const auto key = load<uint16_t>(&body[at]);
    const auto value = load<uint16_t>(&body[at + 6]);
    if (load<uint16_t>(&body[at + 2]) != 0 || value == kUserDefined) continue;
    for (const auto& [number, target] : wanted) {
      if (key == number && value != 0) *target = value;
    }
  }
  return keys;
}

/// The system in the form that crs::read_system reads: projected, or else geographic. Units that are stated win over
/// those of the systems.
std::string system_of_geo_keys(Bytes body) {
  const GeoKeys keys = read_geo_keys(body);
  const uint16_t code = keys.projected != 0 ? keys.projected : keys.geographic;
  if (code == 0) return {};
  std::string text = "EPSG:" + std::to_string(code);
  if (keys.projected != 0 && keys.unit != 0) text += "@" + std::to_string(keys.unit);
  if (keys.projected != 0 && (keys.vertical != 0 || keys.vertical_unit != 0)) {
    text += "+" + std::to_string(keys.vertical) + "@" + std::to_string(keys.vertical_unit);
  }
  return text;
}

/// WKT wins over GeoKeys, whatever the header says which of them there is.
void take_projection(uint16_t id, Bytes body, LasHeader& header) {
  constexpr uint16_t kWkt = 2112;
  constexpr uint16_t kGeoKeys = 34735;
  std::string system = id == kWkt ? stored_text(body) : id == kGeoKeys ? system_of_geo_keys(body) : std::string();
  if (system.empty() || (id == kGeoKeys && !header.crs.empty())) return;
  header.crs = std::move(system);
}

constexpr std::string_view kCopcUser{"copc\0\0\0\0\0\0\0\0\0\0\0\0", 16};

/// Only the first record of each kind counts.
void parse_variable_records(Bytes bytes, LasHeader& header) {
  bool has_extra_fields = false;
  for_each_variable_record(bytes, header.data_offset, [&](std::string_view user, uint16_t id, Bytes body) {
    if (id == 4 && user.starts_with("LASF_Spec") && !has_extra_fields) {
      parse_extra_fields(body, header);
      has_extra_fields = true;
    }
    if (user.starts_with("LASF_Projection")) take_projection(id, body, header);
    if (id == 1 && user == kCopcUser && header.copc_record.empty()) header.copc_record = body;
    if (id == 22204 && user.starts_with("laszip encoded") && header.laszip_record.empty()) header.laszip_record = body;
  });
}

Status check_version(Bytes bytes) {
  const auto major = load<uint8_t>(&bytes[24]);
  const auto minor = load<uint8_t>(&bytes[25]);
  if (major != 1 || minor > 5) {
    return fail(ErrorKind::kUnsupported,
                "LAS version " + std::to_string(major) + "." + std::to_string(minor) + " is not supported");
  }
  const size_t size = load<uint16_t>(&bytes[94]);
  if (size < (minor >= 4 ? kHeaderSize14 : kHeaderSize)) return invalid_input("LAS header size is too small");
  if (size > bytes.size()) return invalid_input("truncated: the file ends within its LAS header");
  return {};
}

Status check_point_format(int point_format) {
  if (point_format <= 10) return {};
  return fail(ErrorKind::kUnsupported, "LAS point format " + std::to_string(point_format) + " is not supported");
}

}  // namespace

size_t las_record_length(int point_format) {
  constexpr std::array<size_t, 11> kLengths = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  return kLengths.at(static_cast<size_t>(point_format));
}

std::vector<LasVariableRecord> las_variable_records(Bytes bytes, const LasHeader& header) {
  std::vector<LasVariableRecord> records;
  for_each_variable_record(bytes, header.data_offset, [&](std::string_view user, uint16_t id, Bytes body) {
    const auto* head = body.data() - kRecordHeaderSize;
    records.push_back({user.substr(0, user.find('\0')), id, {head, kRecordHeaderSize}, body});
  });
  return records;
}

std::vector<LasVariableRecord> las_extended_records(Bytes bytes, const LasHeader& header) {
  constexpr size_t kHeadSize = 60;
  std::vector<LasVariableRecord> records;
  if (header.minor_version < 4) return records;
  const auto count = load<uint32_t>(&bytes[243]);
  uint64_t at = load<uint64_t>(&bytes[235]);
  for (uint32_t i = 0; i < count && at <= bytes.size() && kHeadSize <= bytes.size() - at; ++i) {
    const Bytes head = bytes.subspan(at, kHeadSize);
    const auto length = load<uint64_t>(&head[20]);
    at += kHeadSize;
    if (length > bytes.size() - at) break;
    const std::string_view user = as_text(head.subspan(2, 16));
    records.push_back({user.substr(0, user.find('\0')), load<uint16_t>(&head[18]), head, bytes.subspan(at, length)});
    at += length;
  }
  return records;
}

Result<LasHeader> parse_las_header(Bytes bytes) {
  if (bytes.size() < kHeaderSize) return invalid_input("truncated: the file ends within its LAS header");
  if (Status status = check_version(bytes); !status) return fail(status);
  const auto stated_format = load<uint8_t>(&bytes[104]);
  LasHeader header;
  header.minor_version = load<uint8_t>(&bytes[25]);
  header.compressed = (stated_format & kCompressedBits) != 0;
  header.point_format = stated_format & ~kCompressedBits;
  if (Status status = check_point_format(header.point_format); !status) return fail(status);
  header.record_length = load<uint16_t>(&bytes[105]);
  header.data_offset = load<uint32_t>(&bytes[96]);
  header.count = point_count(bytes, header.minor_version);
  for (int axis = 0; axis < 3; ++axis) {
    header.grid.scale[axis] = load<double>(&bytes[131 + 8 * static_cast<size_t>(axis)]);
    header.grid.offset[axis] = load<double>(&bytes[155 + 8 * static_cast<size_t>(axis)]);
  }
  if (!usable_grid(header.grid)) return invalid_input("LAS scale or offset is not usable");
  if (Status status = check_sizes(bytes, header); !status) return fail(status);
  if (header.count == 0) return invalid_input("has no points");
  parse_variable_records(bytes, header);
  for (const LasVariableRecord& record : las_extended_records(bytes, header)) {
    if (record.user == "LASF_Projection") take_projection(record.id, record.body, header);
  }
  return header;
}

}  // namespace surfcast::scan
