#include "laz/laszip_record.h"

#include <string>
#include <vector>

#include "laz/byte_access.h"
#include "laz/wave_packet_decoder.h"

namespace surfcast::laz {
namespace {

/// The fixed part, including the number of items.
constexpr size_t kFixedBytes = 34;
constexpr size_t kItemBytes = 6;

constexpr uint16_t kPointwise = 1;  // one chunk, without a table
constexpr uint16_t kPointwiseChunked = 2;
constexpr uint16_t kLayeredChunked = 3;

enum ItemType : uint16_t {
  kBytes = 0,
  kPoint10 = 6,
  kGpsTime11 = 7,
  kRgb12 = 8,
  kWavePacket13 = 9,
  kPoint14 = 10,
  kRgb14 = 11,
  kRgbNir14 = 12,
  kWavePacket14 = 13,
  kBytes14 = 14,
};

struct Item {
  uint16_t type;
  uint16_t size;
  uint16_t version;
};

/// Empty if the record is truncated.
std::vector<Item> parse_items(std::span<const std::byte> body) {
  std::vector<Item> items(load<uint16_t>(&body[kFixedBytes - 2]));
  if (body.size() < kFixedBytes + items.size() * kItemBytes) return {};
  const std::byte* at = &body[kFixedBytes - kItemBytes];
  for (Item& item : items) {
    at += kItemBytes;
    item = {load<uint16_t>(at), load<uint16_t>(at + 2), load<uint16_t>(at + 4)};
  }
  return items;
}

/// The items of a layout, regardless of their versions.
std::vector<Item> expected_items(const RecordLayout& layout) {
  std::vector<Item> items;
  const auto extra = static_cast<uint16_t>(layout.extra_bytes());
  if (layout.layered) {
    items.push_back({kPoint14, 30, 0});
    if (layout.infrared) items.push_back({kRgbNir14, 8, 0});
    if (layout.color && !layout.infrared) items.push_back({kRgb14, 6, 0});
    if (layout.wave_packet) items.push_back({kWavePacket14, WavePacket::kBytes, 0});
    if (extra != 0) items.push_back({kBytes14, extra, 0});
    return items;
  }
  items.push_back({kPoint10, 20, 0});
  if (layout.gps_time) items.push_back({kGpsTime11, 8, 0});
  if (layout.color) items.push_back({kRgb12, 6, 0});
  if (layout.wave_packet) items.push_back({kWavePacket13, WavePacket::kBytes, 0});
  if (extra != 0) items.push_back({kBytes, extra, 0});
  return items;
}

Status check_item(const Item& item, const Item& expected, bool layered) {
  if (item.type != expected.type || item.size != expected.size) {
    return fail(ErrorKind::kInvalidInput, "the LAZ items do not fit the point format");
  }
  const uint16_t pointwise_version = item.type == kWavePacket13 ? 1 : 2;
  const bool known = layered ? item.version >= 2 && item.version <= 4 : item.version == pointwise_version;
  if (known) return {};
  return fail(ErrorKind::kUnsupported, "LAZ item type " + std::to_string(item.type) + ", version " +
                                           std::to_string(item.version) + " is not supported");
}

Status check_coder(std::span<const std::byte> body, bool layered) {
  const auto compressor = load<uint16_t>(&body[0]);
  const auto coder = load<uint16_t>(&body[2]);
  if (compressor == (layered ? kLayeredChunked : kPointwiseChunked) && coder == 0) return {};
  if (compressor == kPointwise) {
    return fail(ErrorKind::kUnsupported, "LAZ compressor 1: written by LASzip 1, save it again with a later version");
  }
  return fail(ErrorKind::kUnsupported, "LAZ compressor " + std::to_string(compressor) + " with coder " +
                                           std::to_string(coder) + " is not supported for this point format");
}

}  // namespace

Result<LaszipRecord> parse_laszip_record(std::span<const std::byte> body, const RecordLayout& layout) {
  if (body.size() < kFixedBytes) return fail(ErrorKind::kInvalidInput, "truncated: the LASzip record is too short");
  if (Status status = check_coder(body, layout.layered); !status) return fail(status);
  const std::vector<Item> items = parse_items(body);
  const std::vector<Item> expected = expected_items(layout);
  if (items.size() != expected.size()) {
    return fail(ErrorKind::kInvalidInput, "the LAZ items do not fit the point format");
  }
  for (size_t i = 0; i < items.size(); ++i) {
    if (Status status = check_item(items[i], expected[i], layout.layered); !status) return fail(status);
  }
  LaszipRecord record;
  record.chunk_size = load<uint32_t>(&body[12]);
  record.stale_channels = items.back().version < 4;
  if (record.chunk_size == 0) return fail(ErrorKind::kInvalidInput, "LAZ chunks of no points");
  return record;
}

}  // namespace surfcast::laz
