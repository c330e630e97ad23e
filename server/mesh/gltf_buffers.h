#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "mesh/json_access.h"
#include "mesh/readers.h"

namespace surfcast::mesh {

using Bytes = std::span<const std::byte>;

/// The two parts of a glTF file.
struct GltfParts {
  Json json;
  Bytes binary;  ///< of GLB; empty without
};

/// Splits a file, and checks its version.
Result<GltfParts> split_gltf(Bytes file);

/// The bytes of a data URI, encoded as base64; none if it is not one.
std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri);

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
  /// Opens all buffers. `limit`: for what is decoded from text, and for all values read.
  static Result<GltfBuffers> open(const ModelFile& file, const GltfParts& parts, const scan::DecodingLimit& limit);

  [[nodiscard]] Result<Bytes> view(const Json& json, uint64_t index) const;
  Result<AccessorValues> values(const Json& json, uint64_t accessor);
  /// Counts memory against the limit.
  Status set_aside(uint64_t bytes);
  /// Keep the bytes of views.
  [[nodiscard]] const std::vector<std::shared_ptr<const void>>& contents() const { return contents_; }

 private:
  explicit GltfBuffers(const scan::DecodingLimit& limit) : limit_(limit) {}
  Result<Bytes> open_buffer(const ModelFile& file, const Json& buffer, Bytes binary, bool first);
  Status read_dense(const Json& json, const Json& accessor, AccessorValues& into) const;
  Status read_sparse(const Json& json, const Json& accessor, AccessorValues& into) const;

  scan::DecodingLimit limit_;
  std::vector<Bytes> buffers_;
  std::vector<std::shared_ptr<const void>> contents_;
  uint64_t bytes_ = 0;  ///< of all buffers
  uint64_t set_aside_ = 0;
};

}  // namespace surfcast::mesh
