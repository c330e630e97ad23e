#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

namespace surfcast::exporter {

/// Stores a number in the byte order of files, which is that of the machine.
template <typename T>
void put(std::vector<std::byte>& bytes, size_t at, T number) {
  std::memcpy(&bytes[at], &number, sizeof(T));
}

template <typename T>
void add(std::vector<std::byte>& bytes, T number) {
  bytes.resize(bytes.size() + sizeof(T));
  put(bytes, bytes.size() - sizeof(T), number);
}

inline void put_text(std::vector<std::byte>& bytes, size_t at, std::string_view text) {
  std::memcpy(&bytes[at], text.data(), text.size());
}

inline void add_bytes(std::vector<std::byte>& bytes, std::span<const std::byte> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// A variable length record of LAS.
inline std::vector<std::byte> las_record(std::string_view user, uint16_t id, std::span<const std::byte> body) {
  std::vector<std::byte> record(54);
  put_text(record, 2, user);
  put(record, 18, id);
  put(record, 20, static_cast<uint16_t>(body.size()));
  add_bytes(record, body);
  return record;
}

inline constexpr uint16_t kWktRecord = 2112;

/// The record of a coordinate system as WKT, which has fewer than 65535 bytes.
inline std::vector<std::byte> wkt_record(std::string_view wkt) {
  std::vector<std::byte> body(wkt.size() + 1);
  put_text(body, 0, wkt);
  return las_record("LASF_Projection", kWktRecord, body);
}

}  // namespace surfcast::exporter
