#include "scan/e57_streams.h"

#include <algorithm>
#include <array>
#include <string>

#include "base/invalid_input.h"
#include "scan/scalar_type.h"

namespace surfcast::scan {
namespace {

constexpr uint64_t kSectionHeaderBytes = 32;
constexpr uint64_t kPacketHeaderBytes = 6;
constexpr uint64_t kShortestPacket = 4;
constexpr std::byte kDataPacket{1};
/// Bytes behind the last value, so that a value can be loaded with whatever follows it.
constexpr size_t kSpareBytes = 8;

/// Where the packets of a scan lie, logical.
struct Section {
  uint64_t first = 0;
  uint64_t end = 0;
};

Result<Section> read_section(const E57Pages& pages, const E57Scan& scan) {
  const Result<uint64_t> at = pages.logical(scan.section);
  if (!at) return fail(at);
  std::array<std::byte, kSectionHeaderBytes> header{};
  if (Status status = pages.read(*at, header); !status) return fail(status);
  if (header[0] != std::byte{1}) return invalid_input("the points of an E57 scan are missing");
  const auto size = load<uint64_t>(&header[8]);
  const Result<uint64_t> first = pages.logical(load<uint64_t>(&header[16]));
  if (!first) return fail(first);
  if (size > pages.size() - *at) return invalid_input("truncated: the E57 file ends within its points");
  return Section{*first, *at + size};
}

}  // namespace

Status E57Streams::add_packet(const E57Pages& pages, uint64_t at, uint64_t size) {
  std::vector<std::byte> head(kPacketHeaderBytes + 2 * parts_.size());
  if (head.size() > size) return invalid_input("an E57 packet is too short for its streams");
  if (Status status = pages.read(at, head); !status) return status;
  if (load<uint16_t>(&head[4]) != parts_.size())
    return invalid_input("an E57 packet has not one stream for each field");
  uint64_t place = at + head.size();
  for (size_t field = 0; field < parts_.size(); ++field) {
    const auto length = load<uint16_t>(&head[kPacketHeaderBytes + 2 * field]);
    const uint64_t before = parts_[field].empty() ? 0 : parts_[field].back().end;
    if (length > 0) parts_[field].push_back({before + length, place});
    place += length;
  }
  if (place > at + size) return invalid_input("the streams of an E57 packet are longer than the packet");
  return {};
}

Result<E57Streams> E57Streams::open(const E57Pages& pages, const E57Scan& scan) {
  const Result<Section> section = read_section(pages, scan);
  if (!section) return fail(section);
  E57Streams streams;
  streams.parts_.resize(scan.fields.size());
  for (uint64_t at = section->first; at + kShortestPacket <= section->end;) {
    std::array<std::byte, kShortestPacket> head{};
    if (Status status = pages.read(at, head); !status) return fail(status);
    const uint64_t size = load<uint16_t>(&head[2]) + uint64_t{1};
    if (size < kShortestPacket) return invalid_input("an E57 packet is too short");
    if (Status status = head[0] == kDataPacket ? streams.add_packet(pages, at, size) : Status(); !status) {
      return fail(status);
    }
    at += size;
  }
  for (size_t i = 0; i < scan.fields.size(); ++i) {
    const E57Field& field = scan.fields[i];
    const uint64_t bytes = streams.parts_[i].empty() ? 0 : streams.parts_[i].back().end;
    if (field.coding == E57Coding::kString || field.bits == 0) continue;
    if (scan.count <= bytes * 8 / static_cast<uint64_t>(field.bits)) continue;
    return invalid_input("truncated: an E57 scan states " + std::to_string(scan.count) +
                         " points, its values are fewer");
  }
  return streams;
}

Result<std::vector<std::byte>> E57Streams::read(const E57Pages& pages, size_t field, int bits, uint64_t first,
                                                uint64_t count) const {
  const auto width = static_cast<uint64_t>(bits);
  const uint64_t begin = first * width / 8;
  const uint64_t end = ((first + count) * width + 7) / 8;
  std::vector<std::byte> bytes(end - begin + kSpareBytes);
  const std::vector<Part>& parts = parts_[field];
  auto part = std::upper_bound(parts.begin(), parts.end(), begin,
                               [](uint64_t offset, const Part& candidate) { return offset < candidate.end; });
  for (uint64_t at = begin; at < end; ++part) {
    const uint64_t start = part == parts.begin() ? 0 : std::prev(part)->end;
    const uint64_t stop = std::min(end, part->end);
    const auto to = std::span(bytes).subspan(at - begin, stop - at);
    if (Status status = pages.read(part->place + (at - start), to); !status) return fail(status);
    at = stop;
  }
  return bytes;
}

}  // namespace surfcast::scan
