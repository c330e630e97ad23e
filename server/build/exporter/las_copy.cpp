#include "exporter/las_copy.h"

#include <algorithm>
#include <array>
#include <utility>

#include "exporter/las_bytes.h"

namespace surfcast::exporter {
namespace {

constexpr size_t kPacketSize = 29;
constexpr size_t kGlobalEncoding = 6;
constexpr uint16_t kWaveformBits = 6;  // samples in this file, or in one beside it
constexpr size_t kMinorVersion = 25;
constexpr size_t kSoftware = 58;
constexpr size_t kHeaderSize = 94;
constexpr size_t kWaveformStart = 227;  // from version 1.3 on
constexpr size_t kHeaderSize13 = 235;

struct Target {
  int point_format;      ///< with the same fields but for wave packets
  size_t packet_offset;  ///< in the source
};

/// Point formats 4, 5, 9 and 10.
Target without_waves(int point_format) {
  constexpr std::array<Target, 11> kTargets = {
      {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {1, 28}, {3, 34}, {6, 0}, {7, 0}, {8, 0}, {6, 30}, {8, 38}}};
  return kTargets.at(static_cast<size_t>(point_format));
}

/// Records that would not be true of the copy.
bool is_stale(const scan::LasVariableRecord& record) {
  const bool waveform = record.user == "LASF_Spec" && ((record.id >= 100 && record.id < 355) || record.id == 65535);
  const bool superseded = record.user == "LASF_Spec" && record.id == 7;
  return waveform || superseded || record.user == "laszip encoded" || record.user == "copc" ||
         record.user == "LAStools";  // LAStools: an index, or tiles of a file
}

std::vector<std::vector<std::byte>> kept(const std::vector<scan::LasVariableRecord>& records) {
  std::vector<std::vector<std::byte>> all;
  for (const scan::LasVariableRecord& record : records) {
    if (is_stale(record)) continue;
    all.emplace_back(record.head.begin(), record.head.end());
    add_bytes(all.back(), record.body);
  }
  return all;
}

}  // namespace

LasCopy plan_las_copy(const scan::LasHeader& header, std::span<const std::byte> file, bool compressed) {
  LasCopy copy;
  const Target target = without_waves(header.point_format);
  if (target.packet_offset != 0) {
    copy.packet_offset = target.packet_offset;
    copy.packet_size = kPacketSize;
    copy.notes.emplace_back("its waveforms are left out");
  }
  copy.head.point_format = target.point_format;
  copy.head.record_length = header.record_length - copy.packet_size;
  copy.head.compressed = compressed;
  copy.head.records = kept(scan::las_variable_records(file, header));
  copy.head.extended = kept(scan::las_extended_records(file, header));
  const auto size = scan::load<uint16_t>(&file[kHeaderSize]);
  std::vector<std::byte>& bytes = copy.head.header;
  bytes.assign(file.begin(), file.begin() + size);
  const auto encoding = scan::load<uint16_t>(&bytes[kGlobalEncoding]);
  put(bytes, kGlobalEncoding, static_cast<uint16_t>(encoding & ~kWaveformBits));
  // Versions 1.0 and 1.1 lay out the header as 1.2 does.
  put(bytes, kMinorVersion, static_cast<uint8_t>(std::max(header.minor_version, 2)));
  std::fill_n(bytes.begin() + kSoftware, 32, std::byte{0});
  put_text(bytes, kSoftware, "Surfcast");
  if (header.minor_version >= 3 && bytes.size() >= kHeaderSize13) put(bytes, kWaveformStart, uint64_t{0});
  return copy;
}

std::vector<std::byte> without_packets(std::vector<std::byte> records, const scan::LasHeader& header,
                                       const LasCopy& copy) {
  if (copy.packet_size == 0) return records;
  const size_t behind = copy.packet_offset + copy.packet_size;
  std::vector<std::byte> shorter;
  shorter.reserve(records.size() / header.record_length * copy.head.record_length);
  for (size_t at = 0; at < records.size(); at += header.record_length) {
    const auto record = std::span(records).subspan(at, header.record_length);
    add_bytes(shorter, record.first(copy.packet_offset));
    add_bytes(shorter, record.subspan(behind));
  }
  return shorter;
}

}  // namespace surfcast::exporter
