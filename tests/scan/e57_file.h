#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scan/bytes.h"

namespace surfcast::testing {

/// Writes E57 files byte by byte, after the standard and not after the reader.
class E57File {
 public:
  static constexpr size_t kPage = 128;  ///< smaller than usual, so that everything crosses pages

  /// The physical offset of what is added next.
  [[nodiscard]] size_t physical() const {
    return logical_.size() / (kPage - 4) * kPage + logical_.size() % (kPage - 4);
  }
  /// Adds the points of a scan: packets of one stream for each field. Returns the offset of their section.
  size_t add_points(const std::vector<std::vector<std::string>>& packets) {
    std::string content;
    for (const std::vector<std::string>& streams : packets) content += packet(streams);
    pad(32 + 8);
    const size_t section = physical();
    Bytes head;
    head.add(uint64_t{1}).add(uint64_t{32 + content.size()}).add(uint64_t{after(32)}).add(uint64_t{0});
    logical_ += head.text() + content;
    return section;
  }
  /// The whole file, with the XML section last.
  [[nodiscard]] std::string text(const std::string& xml) {
    const size_t xml_offset = physical();
    logical_ += xml;
    logical_.resize((logical_.size() + kPage - 5) / (kPage - 4) * (kPage - 4));
    const uint64_t size = logical_.size() / (kPage - 4) * kPage;
    Bytes head("ASTM-E57");
    head.add(uint32_t{1}).add(uint32_t{0}).add(size).add(uint64_t{xml_offset}).add(uint64_t{xml.size()});
    head.add(uint64_t{kPage});
    logical_.replace(0, 48, head.text());
    return with_checksums();
  }

 private:
  static uint32_t checksum(std::string_view bytes) {
    uint32_t crc = 0xFFFFFFFFU;
    for (const char c : bytes) {
      crc ^= static_cast<uint8_t>(c);
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0x82F63B78U : 0U);
    }
    return ~crc;
  }
  /// Zeros, so that the next `size` bytes lie in one page.
  void pad(size_t size) {
    if (logical_.size() % (kPage - 4) + size > kPage - 4)
      logical_.resize((logical_.size() / (kPage - 4) + 1) * (kPage - 4));
  }
  [[nodiscard]] size_t after(size_t bytes) const {
    const size_t at = logical_.size() + bytes;
    return at / (kPage - 4) * kPage + at % (kPage - 4);
  }
  static std::string packet(const std::vector<std::string>& streams) {
    std::string body;
    Bytes lengths;
    for (const std::string& stream : streams) {
      lengths.add(static_cast<uint16_t>(stream.size()));
      body += stream;
    }
    size_t size = 6 + lengths.text().size() + body.size();
    body.resize(body.size() + (4 - size % 4) % 4);
    size = 6 + lengths.text().size() + body.size();
    Bytes head;
    head.add(uint8_t{1}).add(uint8_t{0}).add(static_cast<uint16_t>(size - 1));
    head.add(static_cast<uint16_t>(streams.size()));
    return head.text() + lengths.text() + body;
  }
  [[nodiscard]] std::string with_checksums() const {
    std::string file;
    for (size_t at = 0; at < logical_.size(); at += kPage - 4) {
      const std::string page = logical_.substr(at, kPage - 4);
      file += Bytes(page).add(checksum(page), true).text();
    }
    return file;
  }

  std::string logical_ = std::string(48, '\0');
};

/// Numbers of `width` bits, the least significant first.
inline std::string packed(const std::vector<uint64_t>& numbers, int width) {
  std::string bytes((numbers.size() * static_cast<size_t>(width) + 7) / 8, '\0');
  size_t at = 0;
  for (const uint64_t number : numbers) {
    for (int bit = 0; bit < width; ++bit, ++at) {
      if (number >> bit & 1) bytes[at / 8] = static_cast<char>(bytes[at / 8] | 1 << at % 8);
    }
  }
  return bytes;
}

}  // namespace surfcast::testing
