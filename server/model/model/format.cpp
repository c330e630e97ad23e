#include "model/format.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <set>
#include <string_view>

#include "base/hash.h"
#include "geometry/finite.h"
#include "ldc/lattice.h"
#include "model/byte_stream.h"
#include "model/kind_tables.h"
#include "model/quantize.h"

namespace surfcast::model {
namespace {

constexpr std::array<char, 8> kMagic{'S', 'U', 'R', 'F', 'C', 'A', 'S', 'T'};
constexpr size_t kHeaderChecksumAt = kHeaderBytes - sizeof(uint64_t);
constexpr uint16_t kOrientedFlag = 1;
constexpr uint16_t kZUpFlag = 2;
constexpr uint16_t kUpsideDownFlag = 4;
constexpr uint16_t kEvenFlag = 8;
constexpr int kDegreeShift = 4;  // of the degree of harmonics, three bits
constexpr int kMaxDegree = 4;
/// Flag in the type of a scalar attribute: coarse blocks have it too.
constexpr uint8_t kCoarseScalarFlag = 0x80;
/// Half angle in a record without a normal cone.
constexpr float kNoCone = -1;
/// Upper bound of the rotation of an axis by quantization, radians.
constexpr float kAxisError = 0.1f * std::numbers::pi_v<float> / 180;

void put_vector(ByteWriter& writer, const auto& v) {
  writer.put(v.x);
  writer.put(v.y);
  writer.put(v.z);
}

template <typename Vector>
Vector get_vector(ByteReader& reader) {
  using T = typename Vector::value_type;
  const T x = reader.get<T>();
  const T y = reader.get<T>();
  const T z = reader.get<T>();
  return {x, y, z};
}

void put_cone(ByteWriter& writer, const std::optional<geometry::NormalCone>& cone) {
  const geometry::NormalCone stored = cone.value_or(geometry::NormalCone{{0, 0, 1}, kNoCone});
  const glm::u16vec2 axis = encode_normal(stored.axis, kSourcePrecision.octahedral_half);
  writer.put(axis.x);
  writer.put(axis.y);
  writer.put(cone ? std::min(stored.half_angle + kAxisError, std::numbers::pi_v<float>) : kNoCone);
}

std::optional<geometry::NormalCone> get_cone(ByteReader& reader) {
  const auto largest = static_cast<uint16_t>(kSourcePrecision.max_normal_code());
  const auto u = std::min(reader.get<uint16_t>(), largest);
  const auto v = std::min(reader.get<uint16_t>(), largest);
  const auto half_angle = reader.get<float>();
  if (!(half_angle >= 0 && half_angle <= std::numbers::pi_v<float>)) return std::nullopt;
  return geometry::NormalCone{decode_normal({u, v}, kSourcePrecision.octahedral_half), half_angle};
}

void put_block(ByteWriter& writer, const BlockRecord& block) {
  writer.put(block.offset);
  writer.put(block.checksum);
  put_vector(writer, block.origin);
  put_vector(writer, block.extent);
  writer.put(ldc::location_of(block.key));
  writer.put(block.parent);
  writer.put(block.grid);
  writer.put(block.bytes);
  writer.put(block.items);
  writer.put(block.spacing);
  writer.put(block.max_radius);
  put_cone(writer, block.normals);
}

/// None if the octree cell is invalid.
std::optional<BlockRecord> get_block(ByteReader& reader) {
  BlockRecord block;
  block.offset = reader.get<uint64_t>();
  block.checksum = reader.get<uint64_t>();
  block.origin = get_vector<glm::i64vec3>(reader);
  block.extent = get_vector<glm::u32vec3>(reader);
  const std::optional<ldc::OctreeKey> key = ldc::key_at_location(reader.get<uint64_t>());
  block.parent = reader.get<uint32_t>();
  block.grid = reader.get<uint32_t>();
  block.bytes = reader.get<uint32_t>();
  block.items = reader.get<uint32_t>();
  block.spacing = reader.get<float>();
  block.max_radius = reader.get<float>();
  block.normals = get_cone(reader);
  if (!key) return std::nullopt;
  block.key = *key;
  return block;
}

bool valid_grid(const surfel::Grid& grid) {
  return geometry::finite(grid.scale) && geometry::finite(grid.offset) && grid.scale.x > 0 && grid.scale.y > 0 &&
         grid.scale.z > 0;
}

bool valid_lattice_box(const BlockRecord& block, const surfel::Grid& grid) {
  constexpr uint32_t kExtent = uint32_t{1} << ldc::kMaxIndexBits;
  constexpr int64_t kOrigin = int64_t{1} << 62;
  for (int axis = 0; axis < 3; ++axis) {
    if (block.extent[axis] >= kExtent || block.origin[axis] > kOrigin || block.origin[axis] < -kOrigin) return false;
  }
  return geometry::finite(grid.position(block.origin)) &&
         geometry::finite(grid.position(block.origin + glm::i64vec3(block.extent)));
}

bool valid_block(const BlockRecord& block, const Directory& directory, const ModelHeader& header) {
  const bool bytes_inside = block.offset >= kHeaderBytes && block.offset <= header.directory_offset &&
                            block.bytes <= header.directory_offset - block.offset;
  return bytes_inside && block.items >= 1 && block.items <= kMaxBlockSurfels && std::isfinite(block.spacing) &&
         block.spacing > 0 && std::isfinite(block.max_radius) && block.max_radius >= block.spacing &&
         block.grid < directory.grids.size() && valid_lattice_box(block, directory.grids[block.grid]);
}

void put_statistics(ByteWriter& writer, const Directory& directory) {
  writer.put(static_cast<uint32_t>(directory.ranges.size()));
  for (const AttributeRange& range : directory.ranges) {
    writer.put_string(range.attribute);
    for (const double value : {range.smallest, range.largest, range.low, range.high}) writer.put(value);
  }
  writer.put(static_cast<uint32_t>(directory.classes.size()));
  for (const ClassCount& count : directory.classes) {
    writer.put(count.code);
    writer.put(count.surfels);
  }
}

/// Reads a count of items of at least `bytes_each` bytes. If the rest of the buffer is too short for them, returns zero
/// and makes the reader fail, so nothing is allocated for them.
uint32_t get_count(ByteReader& reader, size_t bytes_each) {
  const auto count = reader.get<uint32_t>();
  if (count <= reader.rest().size() / bytes_each) return count;
  reader.get_bytes(reader.rest().size() + 1);
  return 0;
}

tl::unexpected<Error> damaged(const char* what) {
  return fail(ErrorKind::kInvalidInput, what);
}

bool valid_range(const AttributeRange& range, const Directory& directory) {
  const bool known = std::any_of(directory.scalars.begin(), directory.scalars.end(),
                                 [&](const ScalarColumn& scalar) { return scalar.name == range.attribute; });
  return known && std::isfinite(range.smallest) && std::isfinite(range.largest) && range.smallest <= range.low &&
         range.low <= range.high && range.high <= range.largest;
}

Status get_statistics(ByteReader& reader, Directory& directory) {
  constexpr uint32_t kClasses = 256;
  const uint32_t ranges = get_count(reader, 36);
  if (ranges > directory.scalars.size()) return damaged("model has ranges of more attributes than it has");
  for (uint32_t n = ranges; n > 0; --n) {
    AttributeRange range;
    range.attribute = reader.get_string();
    for (double* value : {&range.smallest, &range.largest, &range.low, &range.high}) *value = reader.get<double>();
    if (!valid_range(range, directory)) return damaged("model has a wrong range of an attribute");
    directory.ranges.push_back(std::move(range));
  }
  for (uint32_t n = get_count(reader, 12); n > 0; --n) {
    ClassCount count;
    count.code = reader.get<uint32_t>();
    count.surfels = reader.get<uint64_t>();
    const bool ascending = directory.classes.empty() || directory.classes.back().code < count.code;
    if (count.code >= kClasses || !ascending) return damaged("model has wrong counts of classes");
    directory.classes.push_back(count);
  }
  return {};
}

/// The names of the kinds, then the kind of each block as one byte.
void put_kinds(ByteWriter& writer, const Directory& directory) {
  writer.put(static_cast<uint32_t>(directory.kinds.size()));
  for (const std::string& kind : directory.kinds) writer.put_string(kind);
  for (const BlockRecord& block : directory.blocks) writer.put(block.kind);
}

Status get_kinds(ByteReader& reader, Directory& directory) {
  directory.kinds.clear();
  uint32_t kinds = get_count(reader, 4);
  if (kinds > kMaxKinds) return damaged("model has too many kinds of blocks");
  std::set<std::string_view> names;
  for (; kinds > 0; --kinds) directory.kinds.push_back(reader.get_string());
  for (const std::string& kind : directory.kinds) {
    if (kind.empty() || !names.insert(kind).second)
      return damaged("model has kinds of blocks without names of their own");
  }
  for (BlockRecord& block : directory.blocks) {
    block.kind = reader.get<uint8_t>();
    if (block.kind >= directory.kinds.size()) return damaged("model has a block of no kind");
  }
  return {};
}

/// The number of surfels of each block that lie on no surface.
Status get_scatter(ByteReader& reader, Directory& directory) {
  for (BlockRecord& block : directory.blocks) {
    block.scatter = reader.get<uint32_t>();
    if (block.scatter > block.items) return damaged("model has a wrong count of scatter");
  }
  return {};
}

}  // namespace

uint64_t checksum_of(std::span<const std::byte> bytes) {
  return hash_of(bytes);  // XXH3 without a seed is what the format states
}

std::vector<std::byte> write_header(const ModelHeader& header) {
  ByteWriter writer;
  writer.put_bytes(std::as_bytes(std::span(kMagic)));
  writer.put(header.version);
  writer.put(static_cast<uint16_t>((header.oriented ? kOrientedFlag : 0) | (header.z_up ? kZUpFlag : 0) |
                                   (header.upside_down ? kUpsideDownFlag : 0) | (header.even ? kEvenFlag : 0) |
                                   (header.harmonics_degree << kDegreeShift)));
  writer.put(static_cast<uint16_t>(header.color_bits));
  writer.put(header.file_bytes);
  writer.put(header.directory_offset);
  writer.put(header.directory_bytes);
  writer.put(header.directory_checksum);
  writer.put(header.georeference_offset);
  writer.put(checksum_of(writer.bytes()));
  return std::move(writer).take();
}

Result<ModelHeader> read_header(std::span<const std::byte> head, uint64_t file_bytes) {
  ByteReader reader(head);
  const std::span<const std::byte> magic = reader.get_bytes(kMagic.size());
  if (!reader.ok() || std::memcmp(magic.data(), kMagic.data(), kMagic.size()) != 0) {
    return damaged(kNoModel);
  }
  const auto version = reader.get<uint32_t>();
  if (reader.ok() && (version < kSurfelVersion || version > kEllipsoidsVersion)) {
    return fail(ErrorKind::kUnsupported,
                "model format version " + std::to_string(version) + " is not supported; this program reads versions " +
                    std::to_string(kSurfelVersion) + " to " + std::to_string(kEllipsoidsVersion));
  }
  if (head.size() < kHeaderBytes) return damaged("model is cut off within its header");
  ModelHeader header;
  header.version = version;
  const auto flags = reader.get<uint16_t>();
  header.oriented = (flags & kOrientedFlag) != 0;
  header.z_up = (flags & kZUpFlag) != 0;
  header.upside_down = (flags & kUpsideDownFlag) != 0;
  header.even = (flags & kEvenFlag) != 0;
  header.harmonics_degree = (flags >> kDegreeShift) & 7;
  header.color_bits = reader.get<uint16_t>();
  header.file_bytes = reader.get<uint64_t>();
  header.directory_offset = reader.get<uint64_t>();
  header.directory_bytes = reader.get<uint64_t>();
  header.directory_checksum = reader.get<uint64_t>();
  header.georeference_offset = reader.get<uint64_t>();
  if (reader.get<uint64_t>() != checksum_of(head.first(kHeaderChecksumAt))) return damaged("model header is damaged");
  if (header.color_bits != 0 && header.color_bits != 8 && header.color_bits != 16) {
    return damaged("model header states a wrong colour depth");
  }
  if (header.harmonics_degree > kMaxDegree) return damaged("model header states a wrong degree of harmonics");
  if (header.file_bytes != file_bytes) return damaged("model is cut off or has bytes after its end");
  if (header.directory_offset < kHeaderBytes || header.directory_offset > file_bytes ||
      header.directory_bytes != file_bytes - header.directory_offset) {
    return damaged("model header points outside the file");
  }
  if (header.georeference_offset != 0 &&
      (header.georeference_offset < kHeaderBytes || header.georeference_offset > header.directory_offset)) {
    return damaged("model header points outside the file");
  }
  return header;
}

std::vector<std::byte> write_directory(const Directory& directory) {
  ByteWriter writer;
  writer.put(static_cast<uint32_t>(directory.source_names.size()));
  for (const std::string& name : directory.source_names) writer.put_string(name);
  writer.put(static_cast<uint32_t>(directory.scalars.size()));
  for (const ScalarColumn& scalar : directory.scalars) {
    writer.put(static_cast<uint8_t>(scalar.type | (scalar.coarse ? kCoarseScalarFlag : 0)));
    writer.put_string(scalar.name);
  }
  writer.put(static_cast<uint32_t>(directory.grids.size()));
  for (const surfel::Grid& grid : directory.grids) {
    put_vector(writer, grid.scale);
    put_vector(writer, grid.offset);
  }
  writer.put(static_cast<uint32_t>(directory.blocks.size()));
  for (const BlockRecord& block : directory.blocks) put_block(writer, block);
  put_statistics(writer, directory);
  if (directory.version() >= kKindsVersion) put_kinds(writer, directory);
  if (directory.version() < kScatterVersion) return std::move(writer).take();
  for (const BlockRecord& block : directory.blocks) writer.put(block.scatter);
  if (directory.version() >= kVolumesVersion) put_volumes(writer, directory);
  if (directory.version() >= kEllipsoidsVersion) put_ellipsoid_sources(writer, directory);
  return std::move(writer).take();
}

Result<Directory> read_directory(std::span<const std::byte> bytes, const ModelHeader& header) {
  if (checksum_of(bytes) != header.directory_checksum) return damaged("model tables are damaged");
  ByteReader reader(bytes);
  Directory directory;
  for (uint32_t n = get_count(reader, 4); n > 0; --n) directory.source_names.push_back(reader.get_string());
  uint32_t scalars = get_count(reader, 5);
  if (scalars > kMaxScalars) return damaged("model has too many attributes");
  for (; scalars > 0; --scalars) {
    const auto type = reader.get<uint8_t>();
    const auto plain_type = static_cast<ScalarCode>(type & ~kCoarseScalarFlag);
    if (plain_type >= std::variant_size_v<surfel::ScalarValues>) return damaged("unknown attribute type");
    directory.scalars.push_back({reader.get_string(), plain_type, type != plain_type});
  }
  for (uint32_t n = get_count(reader, 48); n > 0; --n) {
    const auto scale = get_vector<glm::dvec3>(reader);
    directory.grids.push_back({scale, get_vector<glm::dvec3>(reader)});
    if (!valid_grid(directory.grids.back())) return damaged("model has a wrong grid");
  }
  for (uint32_t n = get_count(reader, kBlockRecordBytes); n > 0; --n) {
    const std::optional<BlockRecord> block = get_block(reader);
    if (!block || !valid_block(*block, directory, header)) return damaged("model has a wrong block record");
    directory.blocks.push_back(*block);
  }
  // Older files have no statistics and end here.
  if (reader.ok() && !reader.rest().empty()) {
    if (Status status = get_statistics(reader, directory); !status) return fail(status);
  }
  if (header.version >= kKindsVersion) {
    if (Status status = get_kinds(reader, directory); !status) return fail(status);
  }
  if (header.version >= kScatterVersion) {
    if (Status status = get_scatter(reader, directory); !status) return fail(status);
  }
  if (header.version >= kVolumesVersion) {
    if (Status status = get_volumes(reader, directory); !status) return fail(status);
  } else if (std::ranges::find(directory.kinds, kGridKind) != directory.kinds.end()) {
    return damaged("model has bricks but no volumes");
  }
  if (header.version >= kEllipsoidsVersion) {
    if (Status status = get_ellipsoid_sources(reader, directory); !status) return fail(status);
  }
  if (!reader.ok() || !reader.rest().empty()) return damaged("model tables have a wrong length");
  if (directory.blocks.empty()) return damaged("model has no blocks");
  return directory;
}

}  // namespace surfcast::model
