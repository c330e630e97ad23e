#include "client/chunk_table_place.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace surfcast::client {
namespace {

constexpr size_t kPlaceBytes = 8;
// Of the public header block (LAS 1.4 R15, table 3).
constexpr size_t kOffsetOfPoints = 96;
constexpr size_t kPointFormat = 104;
constexpr uint8_t kCompressed = 0x80;  // set in the point format by LASzip
/// Records before the points; a file with more is left as it is.
constexpr size_t kMaxHead = size_t{16} << 20;

uint64_t number_at(std::string_view bytes, size_t offset, size_t size) {
  uint64_t value = 0;
  std::memcpy(&value, bytes.data() + offset, size);  // little-endian, as all machines are that Surfcast runs on
  return value;
}

/// Where the points begin; nothing if too little of the head is there, or if it is no LAZ.
std::optional<size_t> points_of_laz(std::string_view head) {
  if (head.size() <= kPointFormat || !head.starts_with("LASF")) return std::nullopt;
  if ((static_cast<uint8_t>(head[kPointFormat]) & kCompressed) == 0) return std::nullopt;
  return number_at(head, kOffsetOfPoints, 4);
}

}  // namespace

void ChunkTablePlace::add(std::string_view bytes) {
  size_ += bytes.size();
  if (head_.size() < kMaxHead) {
    head_.append(bytes.substr(0, kMaxHead - head_.size()));
    const std::optional<size_t> points = points_of_laz(head_);
    if (points) head_.resize(std::min(head_.size(), *points + kPlaceBytes));
  }
  tail_.append(bytes.substr(bytes.size() - std::min(bytes.size(), kPlaceBytes)));
  tail_.erase(0, tail_.size() - std::min(tail_.size(), kPlaceBytes));
}

std::optional<ChunkTablePlace::Correction> ChunkTablePlace::correction() const {
  const std::optional<size_t> points = points_of_laz(head_);
  if (!points || head_.size() < *points + kPlaceBytes || size_ < *points + 2 * kPlaceBytes) return std::nullopt;
  if (number_at(head_, *points, kPlaceBytes) != UINT64_MAX) return std::nullopt;
  const uint64_t place = number_at(tail_, 0, kPlaceBytes);
  if (place < *points + kPlaceBytes || place > size_ - kPlaceBytes) return std::nullopt;
  return Correction{*points, tail_};
}

}  // namespace surfcast::client
