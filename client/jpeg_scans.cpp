#include "client/jpeg_scans.h"

#include <cstdint>
#include <optional>

namespace surfcast::client {
namespace {

// Markers (ITU-T T.81, table B.1), without their first byte, which is 0xFF.
constexpr uint8_t kProgressiveFrame = 0xC2;
constexpr uint8_t kFirstRestart = 0xD0;
constexpr uint8_t kLastRestart = 0xD7;
constexpr uint8_t kStartOfFile = 0xD8;
constexpr uint8_t kEndOfFile = 0xD9;
constexpr uint8_t kStartOfScan = 0xDA;
constexpr uint8_t kLastFrequency = 63;

uint8_t byte_at(std::string_view text, size_t at) {
  return static_cast<uint8_t>(text[at]);
}

/// The marker at a place of a file, if both of its bytes are there.
std::optional<uint8_t> marker_at(std::string_view file, size_t at) {
  if (at + 2 > file.size() || byte_at(file, at) != 0xFF) return std::nullopt;
  return byte_at(file, at + 1);
}

/// The parameters behind the marker at a place, if all of them are there.
std::optional<std::string_view> segment_at(std::string_view file, size_t at) {
  if (at + 4 > file.size()) return std::nullopt;
  const size_t length = size_t{byte_at(file, at + 2)} << 8 | byte_at(file, at + 3);
  if (length < 2 || at + 2 + length > file.size()) return std::nullopt;
  return file.substr(at + 4, length - 2);
}

/// Where the next marker begins: the data of a scan have none but restarts (T.81, B.1.1.5).
std::optional<size_t> end_of_scan(std::string_view file, size_t at) {
  for (; at + 1 < file.size(); ++at) {
    if (byte_at(file, at) != 0xFF) continue;
    const uint8_t next = byte_at(file, at + 1);
    if (next != 0 && (next < kFirstRestart || next > kLastRestart)) return at;
  }
  return std::nullopt;
}

/// The first component of a frame (T.81, B.2.2).
std::optional<uint8_t> first_component(std::string_view frame) {
  constexpr size_t kBefore = 6;
  if (frame.size() <= kBefore) return std::nullopt;
  return byte_at(frame, kBefore);
}

/// Whether a scan has the highest frequency of a component (T.81, B.2.3).
bool has_all_of(std::string_view scan, uint8_t component) {
  const size_t components = scan.empty() ? 0 : byte_at(scan, 0);
  if (scan.size() < 1 + 2 * components + 3) return false;
  bool found = false;
  for (size_t i = 0; i < components; ++i) found |= byte_at(scan, 1 + 2 * i) == component;
  return found && byte_at(scan, 2 + 2 * components) == kLastFrequency;
}

}  // namespace

size_t showable_bytes(std::string_view begun) {
  if (marker_at(begun, 0) != kStartOfFile) return 0;
  std::optional<uint8_t> brightness;
  bool known = false;
  size_t complete = 0;
  for (size_t at = 2;;) {
    const std::optional<uint8_t> marker = marker_at(begun, at);
    if (!marker || *marker == kEndOfFile) return complete;
    const std::optional<std::string_view> segment = segment_at(begun, at);
    if (!segment) return complete;
    size_t next = at + 4 + segment->size();
    if (*marker == kProgressiveFrame) brightness = first_component(*segment);
    if (*marker == kStartOfScan) {
      const std::optional<size_t> end = end_of_scan(begun, next);
      if (!brightness || !end) return complete;
      known = known || has_all_of(*segment, *brightness);
      if (known) complete = *end;
      next = *end;
    }
    at = next;
  }
}

}  // namespace surfcast::client
