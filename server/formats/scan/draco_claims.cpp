#include "scan/draco_claims.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/geometry_metadata.h>
#include <draco/metadata/metadata_decoder.h>

namespace surfcast::scan {
namespace {

// Layouts according to the Draco bitstream specification. Numbers that later versions store with variable length had
// four bytes in earlier versions.
constexpr uint16_t version(uint8_t major, uint8_t minor) {
  return static_cast<uint16_t>(DRACO_BITSTREAM_VERSION(major, minor));
}

template <typename T>
std::optional<T> fixed(draco::DecoderBuffer& buffer) {
  T value{};
  return buffer.Decode(&value) ? std::optional(value) : std::nullopt;
}

/// A number that is stored with variable length from bitstream version `since` on.
std::optional<uint32_t> number(draco::DecoderBuffer& buffer, uint16_t since) {
  if (buffer.bitstream_version() < since) return fixed<uint32_t>(buffer);
  uint32_t value = 0;
  return draco::DecodeVarint(&value, &buffer) ? std::optional(value) : std::nullopt;
}

/// Bytes per point of one group of attributes, including four bytes for the index of each value.
std::optional<uint64_t> attribute_bytes(draco::DecoderBuffer& buffer, bool sequential) {
  const std::optional<uint32_t> attributes = number(buffer, version(2, 0));
  if (!attributes) return std::nullopt;
  uint64_t bytes = 0;
  for (uint32_t i = 0; i < *attributes; ++i) {
    const auto kind = fixed<uint8_t>(buffer);
    const auto type = fixed<uint8_t>(buffer);
    const auto components = fixed<uint8_t>(buffer);
    const auto normalized = fixed<uint8_t>(buffer);
    uint32_t id = 0;
    const bool has_id = buffer.bitstream_version() < version(1, 3) ? fixed<uint16_t>(buffer).has_value()
                                                                   : draco::DecodeVarint(&id, &buffer);
    if (!kind || !type || !components || !normalized || !has_id) return std::nullopt;
    bytes += sizeof(uint32_t) + *components * std::max(draco::DataTypeLength(static_cast<draco::DataType>(*type)), 0);
  }
  // A sequential coder stores one byte per attribute here: its coding method.
  if (sequential) buffer.Advance(*attributes);
  return bytes;
}

std::optional<double> cloud_memory(draco::DecoderBuffer& buffer, bool sequential) {
  const auto points = fixed<uint32_t>(buffer);
  const auto groups = fixed<uint8_t>(buffer);
  if (!points || !groups) return std::nullopt;
  uint64_t bytes = 0;
  for (int i = 0; i < *groups; ++i) {
    const std::optional<uint64_t> group = attribute_bytes(buffer, sequential);
    if (!group) return std::nullopt;
    bytes += *group;
  }
  return static_cast<double>(*points) * static_cast<double>(bytes);
}

/// Memory estimate for the connectivity and typical attributes of a mesh. The attributes come too late in the file to
/// be read here.
std::optional<double> mesh_memory(draco::DecoderBuffer& buffer, bool sequential) {
  constexpr double kBytesPerFace = 128;
  uint16_t since = version(2, 2);
  if (!sequential) {
    since = version(2, 0);
    fixed<uint8_t>(buffer);                                                 // traversal method
    if (buffer.bitstream_version() < version(2, 2)) number(buffer, since);  // vertices added by splits
  }
  // Faces and points (sequential), or vertices and faces (edgebreaker). The larger number is used.
  const std::optional<uint32_t> first = number(buffer, since);
  const std::optional<uint32_t> second = number(buffer, since);
  if (!first || !second) return std::nullopt;
  return kBytesPerFace * std::max(*first, *second);
}

std::optional<double> claimed_memory(draco::DecoderBuffer& buffer) {
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return std::nullopt;
  buffer.set_bitstream_version(version(header.version_major, header.version_minor));
  if (buffer.bitstream_version() >= version(1, 3) && (header.flags & METADATA_FLAG_MASK) != 0) {
    draco::GeometryMetadata metadata;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) return std::nullopt;
  }
  if (header.encoder_type == draco::POINT_CLOUD) {
    return cloud_memory(buffer, header.encoder_method == draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  }
  return mesh_memory(buffer, header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING);
}

/// Memory that the file claims to need, in bytes; 0 if the bytes are no Draco file.
double claimed_memory(std::span<const std::byte> bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return claimed_memory(buffer).value_or(0);
}

}  // namespace

bool draco_claims_are_plausible(std::span<const std::byte> bytes) {
  // Decoded scans are 2 to 20 times as large as their coded form.
  constexpr double kAlwaysAllowed = 256.0 * 1024 * 1024;
  constexpr double kMaxExpansion = 256;
  const double allowed = std::max(kAlwaysAllowed, kMaxExpansion * static_cast<double>(bytes.size()));
  return claimed_memory(bytes) <= allowed;
}

uint64_t draco_decoded_bytes(std::span<const std::byte> bytes) {
  return static_cast<uint64_t>(claimed_memory(bytes));
}

}  // namespace surfcast::scan
