#include "exporter/las14.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "crs/coordinate_system.h"
#include "exporter/las_bytes.h"
#include "scan/las_header.h"

namespace surfcast::exporter {
namespace {

constexpr size_t kHeaderBytes14 = 375;
constexpr size_t kEncodingAt = 6;
constexpr uint16_t kWktBit = 16;
constexpr uint16_t kTimeOffsetBit = 64;  // LAS 1.5
constexpr size_t kTimeOffsetAt = 391;
constexpr size_t kMinorAt = 25;
constexpr size_t kHeaderBytesAt = 94;
constexpr size_t kWaveformStartAt = 227;
constexpr double kAngleStep = 0.006;  // degrees

uint8_t bits(const std::byte* record, size_t at) {
  return std::to_integer<uint8_t>(record[at]);
}

/// The fields of point formats 0 to 5 up to the point source, as those of 6 and later (LAS 1.4, tables 7 and 15).
void widen_core(const std::byte* from, std::vector<std::byte>& to, size_t at) {
  std::copy_n(from, 14, &to[at]);
  const uint8_t returns = bits(from, 14), classes = bits(from, 15);
  put(to, at + 14, static_cast<uint8_t>((returns & 7) | (returns >> 3 & 7) << 4));
  put(to, at + 15, static_cast<uint8_t>((classes >> 5) | (returns & 0xC0)));
  put(to, at + 16, static_cast<uint8_t>(classes & 31));
  put(to, at + 17, bits(from, 17));
  const double steps = std::round(scan::load<int8_t>(from + 16) / kAngleStep);
  put(to, at + 18, static_cast<int16_t>(steps));
  std::copy_n(from + 18, 2, &to[at + 20]);
}

bool is_projection(const std::vector<std::byte>& record) {
  constexpr std::string_view kUser = "LASF_Projection";
  return std::string_view(reinterpret_cast<const char*>(&record[2]), kUser.size()) == kUser;
}

bool is_wkt(const std::vector<std::byte>& record) {
  return is_projection(record) && scan::load<uint16_t>(&record[18]) == kWktRecord;
}

bool is_geo_key(const std::vector<std::byte>& record) {
  const auto id = scan::load<uint16_t>(&record[18]);
  return is_projection(record) && id >= 34735 && id <= 34737;
}

/// States the system as WKT. Returns whether it is stated.
bool state_wkt(LasHead& head, const std::string& crs) {
  if (std::ranges::any_of(head.records, is_wkt) || std::ranges::any_of(head.extended, is_wkt)) return true;
  const Result<crs::CoordinateSystem> system = crs::read_system(crs);
  if (!system || system->wkt.size() >= UINT16_MAX) return false;
  head.records.push_back(wkt_record(system->wkt));
  return true;
}

}  // namespace

int modern_point_format(int point_format) {
  return point_format >= 6 ? point_format : point_format >= 2 ? 7 : 6;
}

std::vector<std::byte> modern_records(std::vector<std::byte> records, int point_format, size_t record_bytes) {
  if (point_format >= 6) return records;
  const size_t core = scan::las_record_length(point_format), extra = record_bytes - core;
  const size_t modern_core = scan::las_record_length(modern_point_format(point_format));
  const bool timed = point_format == 1 || point_format == 3, colored = point_format >= 2;
  std::vector<std::byte> modern(records.size() / record_bytes * (modern_core + extra));
  size_t at = 0;
  for (size_t i = 0; i < records.size(); i += record_bytes, at += modern_core + extra) {
    const std::byte* from = &records[i];
    widen_core(from, modern, at);
    if (timed) std::copy_n(from + 20, 8, &modern[at + 22]);
    if (colored) std::copy_n(from + core - 6, 6, &modern[at + 30]);
    std::copy_n(from + core, extra, modern.begin() + static_cast<ptrdiff_t>(at + modern_core));
  }
  return modern;
}

std::vector<std::string> become_version_14(LasHead& head, const std::string& crs) {
  std::vector<std::string> notes;
  const int modern = modern_point_format(head.point_format);
  head.record_length += scan::las_record_length(modern) - scan::las_record_length(head.point_format);
  head.point_format = modern;
  auto encoding = scan::load<uint16_t>(&head.header[kEncodingAt]);
  if ((encoding & kTimeOffsetBit) != 0 && head.header.size() >= kTimeOffsetAt + sizeof(uint16_t)) {
    const auto offset = scan::load<uint16_t>(&head.header[kTimeOffsetAt]);
    notes.push_back("its GPS times begin at " + std::to_string(offset) + " million seconds, which LAS 1.4 cannot say");
  }
  encoding &= static_cast<uint16_t>(~kTimeOffsetBit);
  if (scan::load<uint8_t>(&head.header[kMinorAt]) < 3) head.header.resize(kWaveformStartAt);
  head.header.resize(kHeaderBytes14);
  put(head.header, kMinorAt, uint8_t{4});
  put(head.header, kHeaderBytesAt, static_cast<uint16_t>(kHeaderBytes14));
  const bool stated = state_wkt(head, crs);
  if (stated) std::erase_if(head.records, is_geo_key);
  // Point formats from 6 on set the bit even where no system is stated.
  const bool keyed = std::ranges::any_of(head.records, is_geo_key);
  put(head.header, kEncodingAt, static_cast<uint16_t>(keyed ? encoding : encoding | kWktBit));
  if (!stated && !crs.empty()) notes.push_back("its coordinate system is not known and is kept as it is: " + crs);
  return notes;
}

}  // namespace surfcast::exporter
