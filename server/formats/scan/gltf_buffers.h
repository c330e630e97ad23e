#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "scan/json_access.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// The two parts of a glTF file.
struct GltfParts {
  Json json;
  std::span<const std::byte> binary;  ///< of GLB; empty without
};

inline constexpr const char* kMeshoptExtension = "EXT_meshopt_compression";

/// True for text that begins like glTF.
bool is_gltf_text(std::string_view text);

/// Splits a file, and checks its version.
Result<GltfParts> split_gltf(std::span<const std::byte> file);

/// The bytes of a data URI, encoded as base64; none if it is not one.
std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri);

/// Types of components (glTF 2.0, section 3.6.2.2).
enum GltfType : uint64_t { kGltfInt8 = 5120, kGltfUint8, kGltfInt16, kGltfUint16, kGltfUint32 = 5125, kGltfFloat };

/// Values of an accessor, component fastest. Normalised integers are from -1 or 0 to 1.
struct AccessorValues {
  size_t components = 0;
  std::vector<double> values;

  [[nodiscard]] size_t count() const { return components == 0 ? 0 : values.size() / components; }
};

/// The buffers of a glTF file, and what lies in them. Offsets, strides and counts are checked before memory is set
/// aside.
class GltfBuffers {
 public:
  /// Opens all buffers. `file`: the path of the glTF file, whose folder holds the buffers that it names. `limit`: for
  /// what is decoded from text, and for all values read.
  static Result<GltfBuffers> open(const std::filesystem::path& file, const GltfParts& parts,
                                  const DecodingLimit& limit);

  /// The bytes of a buffer view, decompressed where it says so (EXT_meshopt_compression).
  Result<std::span<const std::byte>> view(const Json& json, uint64_t index);
  Result<AccessorValues> values(const Json& json, uint64_t accessor);
  /// Of all buffers, and of what is compressed in them.
  [[nodiscard]] uint64_t bytes() const { return bytes_; }
  /// Counts memory against the limit.
  Status set_aside(uint64_t bytes);
  /// Keep the bytes of views.
  [[nodiscard]] const std::vector<std::shared_ptr<const void>>& contents() const { return contents_; }

 private:
  explicit GltfBuffers(const DecodingLimit& limit) : limit_(limit) {}
  Result<std::span<const std::byte>> open_buffer(const std::filesystem::path& file, const Json& buffer,
                                                 std::span<const std::byte> binary, bool first);
  /// The bytes that a view or its compressed form names.
  [[nodiscard]] Result<std::span<const std::byte>> range(const Json& stated) const;
  Result<std::span<const std::byte>> decompress(const Json& packed, uint64_t index);
  Status read_dense(const Json& json, const Json& accessor, AccessorValues& into);
  Status read_sparse(const Json& json, const Json& accessor, AccessorValues& into);

  DecodingLimit limit_;
  std::vector<std::span<const std::byte>> buffers_;
  std::vector<std::shared_ptr<const void>> contents_;
  uint64_t bytes_ = 0;
  uint64_t set_aside_ = 0;
  std::map<uint64_t, std::span<const std::byte>> decompressed_;  ///< views
};

}  // namespace surfcast::scan
