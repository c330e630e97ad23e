#include "scan/gltf_buffers.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "base/invalid_input.h"
#include "base/json_text.h"
#include "base/mapped_file.h"
#include "scan/meshopt.h"
#include "scan/named_file.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

using Bytes = std::span<const std::byte>;

uint32_t word_at(Bytes bytes, size_t offset) {
  uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

Result<Json> parse_json(Bytes bytes) {
  Json json = parse_json_text(as_text(bytes));
  if (json.is_discarded() || !json.is_object()) return invalid_input("glTF file whose JSON cannot be read");
  const std::string version = text_of(member(json, "asset"), "version");
  if (!version.starts_with("2.")) {
    return fail(ErrorKind::kUnsupported, "glTF of version " + printable(version) + " is not supported");
  }
  return json;
}

// The container of GLB (glTF 2.0, section 4): a header of 12 bytes and chunks of length, type and data.
constexpr size_t kHeader = 12;
constexpr size_t kChunkHeader = 8;
constexpr uint32_t kJsonChunk = 0x4E4F534A;
constexpr uint32_t kBinaryChunk = 0x004E4942;

/// The first chunk of the type; empty if there is none.
Result<Bytes> find_chunk(Bytes file, uint32_t type) {
  size_t at = kHeader;
  while (at + kChunkHeader <= file.size()) {
    const uint32_t length = word_at(file, at);
    if (length > file.size() - at - kChunkHeader)
      return invalid_input("truncated: GLB chunk beyond the end of the file");
    if (word_at(file, at + 4) == type) return file.subspan(at + kChunkHeader, length);
    at += kChunkHeader + length;
  }
  return Bytes();
}

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  return c == '/' || c == '_' ? 63 : -1;
}

size_t component_size(uint64_t type) {
  switch (type) {
    case kGltfInt8:
    case kGltfUint8:
      return 1;
    case kGltfInt16:
    case kGltfUint16:
      return 2;
    case kGltfUint32:
    case kGltfFloat:
      return 4;
    default:
      return 0;
  }
}

size_t component_count(const std::string& type) {
  constexpr std::array<std::pair<const char*, size_t>, 5> kCounts{
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}}};
  for (const auto& [name, count] : kCounts) {
    if (type == name) return count;
  }
  return 0;
}

template <typename T>
double load_as(const std::byte* at, bool normalized) {
  T value{};
  std::memcpy(&value, at, sizeof value);
  if constexpr (std::is_integral_v<T>) {
    if (normalized) return std::max(static_cast<double>(value) / std::numeric_limits<T>::max(), -1.0);
  }
  return static_cast<double>(value);
}

double component_at(const std::byte* at, uint64_t type, bool normalized) {
  switch (type) {
    case kGltfInt8:
      return load_as<int8_t>(at, normalized);
    case kGltfUint8:
      return load_as<uint8_t>(at, normalized);
    case kGltfInt16:
      return load_as<int16_t>(at, normalized);
    case kGltfUint16:
      return load_as<uint16_t>(at, normalized);
    case kGltfUint32:
      return load_as<uint32_t>(at, false);
    default:
      return load_as<float>(at, false);
  }
}

/// `count` items in a view, `stride` bytes apart.
struct ItemRun {
  Bytes bytes;
  uint64_t count = 0;
  uint64_t item = 0;  ///< bytes
  uint64_t stride = 0;
};

Status check_run(const ItemRun& run) {
  if (run.count == 0) return {};
  const bool fits = run.item <= run.bytes.size() && run.stride >= run.item &&
                    (run.count - 1) <= (run.bytes.size() - run.item) / std::max<uint64_t>(run.stride, 1);
  if (fits) return {};
  return invalid_input("glTF accessor beyond the end of its buffer view");
}

/// What an accessor states of its items.
struct AccessorType {
  uint64_t component = 0;
  size_t components = 0;
  bool normalized = false;

  explicit AccessorType(const Json& accessor)
      : component(integer_of(accessor, "componentType").value_or(0)),
        components(component_count(text_of(accessor, "type"))),
        normalized(flag_of(accessor, "normalized")) {}

  [[nodiscard]] size_t item() const { return component_size(component) * components; }
};

void read_item(const std::byte* from, const AccessorType& type, double* to) {
  const size_t size = component_size(type.component);
  for (size_t k = 0; k < type.components; ++k) to[k] = component_at(from + k * size, type.component, type.normalized);
}

MeshoptView meshopt_view(const Json& packed, std::string_view mode, std::string_view filter) {
  return {integer_of(packed, "count").value_or(0), integer_of(packed, "byteStride").value_or(0), mode, filter};
}

}  // namespace

bool is_gltf_text(std::string_view text) {
  constexpr size_t kLook = 65536;
  const size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '{' &&
         text.substr(0, kLook).find("\"asset\"") != std::string_view::npos;
}

Result<GltfParts> split_gltf(Bytes file) {
  if (!as_text(file).starts_with("glTF")) {
    Result<Json> json = parse_json(file);
    if (!json) return fail(json);
    return GltfParts{std::move(*json), {}};
  }
  if (file.size() < kHeader + kChunkHeader) return invalid_input("truncated: GLB header");
  if (word_at(file, 4) != 2) {
    return fail(ErrorKind::kUnsupported, "GLB of version " + std::to_string(word_at(file, 4)) + " is not supported");
  }
  const Result<Bytes> text = find_chunk(file, kJsonChunk);
  if (!text) return fail(text);
  const Result<Bytes> binary = find_chunk(file, kBinaryChunk);
  if (!binary) return fail(binary);
  Result<Json> json = parse_json(*text);
  if (!json) return fail(json);
  return GltfParts{std::move(*json), *binary};
}

std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri) {
  constexpr std::string_view kMark = ";base64,";
  const size_t mark = uri.find(kMark);
  if (!uri.starts_with("data:") || mark == std::string_view::npos) return std::nullopt;
  std::vector<std::byte> bytes;
  uint32_t bits = 0;
  int held = 0;
  for (const char c : uri.substr(mark + kMark.size())) {
    const int digit = base64_digit(c);
    if (digit < 0) continue;  // padding and white space
    bits = (bits << 6) | static_cast<uint32_t>(digit);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes.push_back(static_cast<std::byte>((bits >> held) & 255U));
  }
  return bytes;
}

Result<GltfBuffers> GltfBuffers::open(const std::filesystem::path& file, const GltfParts& parts,
                                      const DecodingLimit& limit) {
  GltfBuffers buffers(limit);
  for (const Json& buffer : member(parts.json, "buffers")) {
    const Result<Bytes> bytes = buffers.open_buffer(file, buffer, parts.binary, buffers.buffers_.empty());
    if (!bytes) return fail(bytes);
    buffers.buffers_.push_back(*bytes);
    buffers.bytes_ += bytes->size();
  }
  for (const Json& view : member(parts.json, "bufferViews")) {
    const Json& packed = member(member(view, "extensions"), kMeshoptExtension);
    const Result<Bytes> bytes = buffers.range(packed);
    const MeshoptView stated = meshopt_view(packed, {}, {});
    if (bytes && meshopt_claim_is_plausible(*bytes, stated)) buffers.bytes_ += stated.count * stated.stride;
  }
  return buffers;
}

Result<Bytes> GltfBuffers::open_buffer(const std::filesystem::path& file, const Json& buffer, Bytes binary,
                                       bool first) {
  const std::string uri = text_of(buffer, "uri");
  if (uri.empty()) return first ? binary : Bytes();
  if (std::optional<std::vector<std::byte>> decoded = decode_data_uri(uri)) {
    if (Status status = set_aside(decoded->size()); !status) return fail(status);
    const auto kept = std::make_shared<const std::vector<std::byte>>(std::move(*decoded));
    contents_.push_back(kept);
    return Bytes(*kept);
  }
  const std::optional<std::filesystem::path> path = named_file(file, uri);
  if (!path) return invalid_input("names a buffer that is not in its folder: " + printable(uri));
  Result<MappedFile> mapped = MappedFile::open(*path);
  if (!mapped) return fail(ErrorKind::kNotFound, "its buffer cannot be read: " + printable(uri));
  const auto kept = std::make_shared<const MappedFile>(std::move(*mapped));
  contents_.push_back(kept);
  return kept->bytes();
}

Status GltfBuffers::set_aside(uint64_t bytes) {
  set_aside_ += std::min(bytes, std::numeric_limits<uint64_t>::max() - set_aside_);
  return limit_.check(set_aside_);
}

Result<Bytes> GltfBuffers::range(const Json& stated) const {
  const std::optional<uint64_t> buffer = integer_of(stated, "buffer");
  const uint64_t offset = integer_of(stated, "byteOffset").value_or(0);
  const std::optional<uint64_t> length = integer_of(stated, "byteLength");
  if (!buffer || *buffer >= buffers_.size() || !length) return invalid_input("glTF buffer view that is not there");
  const Bytes bytes = buffers_[static_cast<size_t>(*buffer)];
  if (offset > bytes.size() || *length > bytes.size() - offset) {
    return invalid_input("truncated: glTF buffer view beyond the end of its buffer");
  }
  return bytes.subspan(static_cast<size_t>(offset), static_cast<size_t>(*length));
}

Result<Bytes> GltfBuffers::decompress(const Json& packed, uint64_t index) {
  if (const auto known = decompressed_.find(index); known != decompressed_.end()) return known->second;
  const Result<Bytes> bytes = range(packed);
  if (!bytes) return fail(bytes);
  const std::string mode = text_of(packed, "mode");
  const std::string filter = text_of(packed, "filter");
  const MeshoptView stated = meshopt_view(packed, mode, filter);
  if (!meshopt_claim_is_plausible(*bytes, stated)) return invalid_input("damaged or truncated meshopt data");
  if (Status status = set_aside(stated.count * stated.stride); !status) return fail(status);
  Result<std::vector<std::byte>> made = decode_meshopt(*bytes, stated);
  if (!made) return fail(made);
  const auto kept = std::make_shared<const std::vector<std::byte>>(std::move(*made));
  contents_.push_back(kept);
  return decompressed_[index] = Bytes(*kept);
}

Result<Bytes> GltfBuffers::view(const Json& json, uint64_t index) {
  const Json& stated = element(member(json, "bufferViews"), index);
  const Json& packed = member(member(stated, "extensions"), kMeshoptExtension);
  return packed.is_object() ? decompress(packed, index) : range(stated);
}

Status GltfBuffers::read_dense(const Json& json, const Json& accessor, AccessorValues& into) {
  const AccessorType type(accessor);
  const std::optional<uint64_t> number = integer_of(accessor, "bufferView");
  if (!number) return {};  // zeros
  const Result<Bytes> bytes = view(json, *number);
  if (!bytes) return fail(bytes);
  const uint64_t offset = integer_of(accessor, "byteOffset").value_or(0);
  if (offset > bytes->size()) return invalid_input("glTF accessor beyond the end of its buffer view");
  const uint64_t stated = integer_of(element(member(json, "bufferViews"), *number), "byteStride").value_or(0);
  const ItemRun run{bytes->subspan(static_cast<size_t>(offset)), into.count(), type.item(),
                    stated == 0 ? type.item() : stated};
  if (Status status = check_run(run); !status) return status;
  for (size_t i = 0; i < run.count; ++i) {
    read_item(run.bytes.data() + i * run.stride, type, into.values.data() + i * type.components);
  }
  return {};
}

Status GltfBuffers::read_sparse(const Json& json, const Json& accessor, AccessorValues& into) {
  const Json& sparse = member(accessor, "sparse");
  if (!sparse.is_object()) return {};
  const AccessorType type(accessor);
  const Json& indices = member(sparse, "indices");
  const Json& values = member(sparse, "values");
  const uint64_t count = integer_of(sparse, "count").value_or(0);
  const uint64_t index_type = integer_of(indices, "componentType").value_or(0);
  const auto run_of = [&](const Json& part, uint64_t item) -> Result<ItemRun> {
    const Result<Bytes> bytes = view(json, integer_of(part, "bufferView").value_or(UINT64_MAX));
    if (!bytes) return fail(bytes);
    const uint64_t offset = integer_of(part, "byteOffset").value_or(0);
    if (offset > bytes->size()) return invalid_input("glTF accessor beyond the end of its buffer view");
    ItemRun run{bytes->subspan(static_cast<size_t>(offset)), count, item, item};
    if (Status status = check_run(run); !status) return fail(status);
    return run;
  };
  const Result<ItemRun> where = run_of(indices, component_size(index_type));
  if (!where) return fail(where);
  const Result<ItemRun> what = run_of(values, type.item());
  if (!what) return fail(what);
  if (where->item == 0) return invalid_input("glTF accessor of an unknown type");
  for (size_t i = 0; i < count; ++i) {
    const double index = component_at(where->bytes.data() + i * where->stride, index_type, false);
    if (!(index >= 0 && index < static_cast<double>(into.count())))
      return invalid_input("glTF sparse index beyond its accessor");
    read_item(what->bytes.data() + i * what->stride, type,
              into.values.data() + static_cast<size_t>(index) * type.components);
  }
  return {};
}

Result<AccessorValues> GltfBuffers::values(const Json& json, uint64_t accessor) {
  const Json& stated = element(member(json, "accessors"), accessor);
  const AccessorType type(stated);
  const std::optional<uint64_t> count = integer_of(stated, "count");
  if (!count || type.item() == 0) return invalid_input("glTF accessor of an unknown type, or that is not there");
  // Even the zeros of an accessor without a view stand for as many values as the buffers could hold.
  if (*count > bytes_) return invalid_input("glTF accessor of more values than its buffers can hold");
  if (Status status = set_aside(*count * type.components * sizeof(double)); !status) return fail(status);
  AccessorValues values{type.components, std::vector<double>(static_cast<size_t>(*count) * type.components)};
  if (Status status = read_dense(json, stated, values); !status) return fail(status);
  if (Status status = read_sparse(json, stated, values); !status) return fail(status);
  return values;
}

}  // namespace surfcast::scan
