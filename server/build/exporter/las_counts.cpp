#include "exporter/las_counts.h"

#include <algorithm>

#include "base/contract.h"
#include "exporter/las_bytes.h"
#include "exporter/las_coding.h"
#include "scan/scalar_type.h"

namespace surfcast::exporter {
namespace {

using scan::load;

// Offsets in the public header block: LAS 1.4 specification, table 3.
constexpr size_t kMinorVersionAt = 25;
constexpr size_t kDataOffset = 96;
constexpr size_t kRecordCount = 100;
constexpr size_t kPointFormat = 104;
constexpr size_t kRecordLength = 105;
constexpr size_t kLegacyCount = 107;
constexpr size_t kLegacyReturns = 111;
constexpr size_t kScale = 131;
constexpr size_t kOffset = 155;
constexpr size_t kBounds = 179;  // largest and smallest x, then y, then z
constexpr size_t kExtendedPlace = 235;
constexpr size_t kExtendedNumber = 243;
constexpr size_t kCount = 247;
constexpr size_t kReturns = 255;
constexpr uint8_t kCompressedBit = 0x80;

/// Return number of a record; 0 counts as none.
size_t return_of(const std::byte* record, int point_format) {
  return std::to_integer<size_t>(record[14]) & (point_format < 6 ? 7U : 15U);
}

}  // namespace

bool LasHead::has_wide_counts() const {
  return load<uint8_t>(&header[kMinorVersionAt]) >= 4;
}

void LasCounts::add(std::span<const std::byte> records, const LasHead& head) {
  points += records.size() / head.record_length;
  for (size_t at = 0; at < records.size(); at += head.record_length) {
    const std::byte* record = &records[at];
    for (size_t axis = 0; axis < 3; ++axis) {
      const auto number = load<int32_t>(record + 4 * axis);
      low[axis] = std::min(low[axis], number);
      high[axis] = std::max(high[axis], number);
    }
    const size_t number = return_of(record, head.point_format);
    if (number > 0) ++returns[number - 1];
  }
}

void add_laszip_record(LasHead& head) {
  if (!head.compressed) return;
  head.records.push_back(las_record("laszip encoded", 22204, laz::encode_laszip_record(coding_of(head))));
}

/// Point formats from 6 on have no counts of 32 bits, and versions before 1.4 no others.
void fill_in_header(LasHead& head, const LasCounts& counts, size_t data_offset) {
  std::vector<std::byte>& header = head.header;
  put(header, kDataOffset, static_cast<uint32_t>(data_offset));
  put(header, kRecordCount, static_cast<uint32_t>(head.records.size()));
  put(header, kPointFormat, static_cast<uint8_t>(head.point_format | (head.compressed ? kCompressedBit : 0)));
  put(header, kRecordLength, static_cast<uint16_t>(head.record_length));
  const bool legacy = head.point_format < 6 && counts.points <= UINT32_MAX;
  put(header, kLegacyCount, legacy ? static_cast<uint32_t>(counts.points) : 0U);
  for (size_t i = 0; i < 5; ++i) {
    put(header, kLegacyReturns + 4 * i, legacy ? static_cast<uint32_t>(counts.returns[i]) : 0U);
  }
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto scale = load<double>(&header[kScale + 8 * axis]), offset = load<double>(&header[kOffset + 8 * axis]);
    const double a = counts.low[axis] * scale + offset, b = counts.high[axis] * scale + offset;
    put(header, kBounds + 16 * axis, std::max(a, b));  // a scale may be negative
    put(header, kBounds + 16 * axis + 8, std::min(a, b));
  }
  if (!head.has_wide_counts()) return;
  put(header, kCount, counts.points);
  for (size_t i = 0; i < counts.returns.size(); ++i) put(header, kReturns + 8 * i, counts.returns[i]);
}

void drop_extended_records(LasHead& head) {
  head.extended.clear();
  if (!head.has_wide_counts()) return;
  put(head.header, kExtendedPlace, uint64_t{0});
  put(head.header, kExtendedNumber, uint32_t{0});
}

scan::LasHeader header_of(LasHead head) {
  head.compressed = true;
  add_laszip_record(head);
  drop_extended_records(head);
  const LasCounts any{.points = 1, .returns = {}, .low = {}, .high = {}};
  fill_in_header(head, any, bytes_before_points(head).size() - sizeof(int64_t));
  const Result<scan::LasHeader> header = scan::parse_las_header(bytes_before_points(head));
  SURFCAST_EXPECTS(header);
  return *header;
}

geometry::Box bounds_of(const surfel::Grid& grid, const LasCounts& counts) {
  geometry::Box box;
  box.include(grid.position({counts.low[0], counts.low[1], counts.low[2]}));
  box.include(grid.position({counts.high[0], counts.high[1], counts.high[2]}));
  return box;
}

std::vector<std::byte> bytes_before_points(const LasHead& head) {
  std::vector<std::byte> bytes = head.header;
  for (const std::vector<std::byte>& record : head.records) add_bytes(bytes, record);
  if (head.compressed) add(bytes, int64_t{-1});
  return bytes;
}

}  // namespace surfcast::exporter
