#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "gaussian/ply_columns.h"
#include "gaussian/readers.h"
#include "scan/ply_header.h"

namespace surfcast::gaussian {
namespace {

const scan::PlyElement* find_element(const scan::PlyHeader& header, std::string_view name) {
  const auto at = std::find_if(header.elements.begin(), header.elements.end(),
                               [name](const scan::PlyElement& element) { return element.name == name; });
  return at == header.elements.end() ? nullptr : &*at;
}

bool has_property(const scan::PlyElement& element, std::string_view name) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [name](const scan::PlyProperty& property) { return property.name == name; });
}

/// The degree with that many coefficients beyond the constant, of three colours.
std::optional<int> degree_of(size_t coefficients) {
  for (int degree = 0; degree <= 4; ++degree) {
    if ((harmonics_of(degree) - 1) * 3 == coefficients) return degree;
  }
  return std::nullopt;
}

/// f_rest_0, f_rest_1 and so on, as many as there are.
size_t count_rest(const PlyColumns& columns) {
  size_t count = 0;
  while (columns.has("f_rest_" + std::to_string(count))) ++count;
  return count;
}

Result<int> degree_of_rest(const PlyColumns& columns) {
  const size_t count = count_rest(columns);
  const std::optional<int> degree = degree_of(count);
  if (degree) return *degree;
  return fail(ErrorKind::kInvalidInput,
              std::to_string(count) + " properties f_rest, which is not the number of any degree of harmonics");
}

/// Where f_rest_k goes: files have all coefficients of red first, then green, then blue.
size_t place_of_rest(size_t k, int degree) {
  const size_t per_channel = harmonics_of(degree) - 1;
  return (1 + k % per_channel) * 3 + k / per_channel;
}

Result<uint64_t> vertex_count(const stream::FilePtr& file) {
  const Result<scan::PlyHeader> header = scan::parse_ply_header(file->bytes());
  if (!header) return fail(header);
  const scan::PlyElement* vertex = find_element(*header, "vertex");
  if (vertex == nullptr || vertex->count == 0) return fail(ErrorKind::kInvalidInput, "has no Gaussians");
  return vertex->count;
}

class PlyGaussians final : public GaussianSource {
 public:
  PlyGaussians(PlyColumns columns, GaussianTraits traits) : columns_(std::move(columns)), traits_(std::move(traits)) {}

  [[nodiscard]] const GaussianTraits& traits() const override { return traits_; }

  Result<Gaussians> read(uint64_t first, uint64_t count) override {
    Gaussians gaussians = make_gaussians(count, traits_.degree);
    if (Status status = read_into(first, count, gaussians); !status) return fail(status);
    return gaussians;
  }

 private:
  template <typename Use>
  Status take(const std::string& name, uint64_t first, uint64_t count, Use&& use) {
    return columns_.for_each<double>(name, first, count, std::forward<Use>(use));
  }

  Status read_into(uint64_t first, uint64_t count, Gaussians& g) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::string name(1, static_cast<char>('x' + axis));
      Status status = take(name, first, count, [&](size_t i, double value) { g.positions[i][axis] = value; });
      if (!status) return status;
    }
    for (int axis = 0; axis < (traits_.flat ? 2 : 3); ++axis) {
      Status status = take("scale_" + std::to_string(axis), first, count,
                           [&](size_t i, double value) { g.scales[i][axis] = static_cast<float>(std::exp(value)); });
      if (!status) return status;
    }
    Status status =
        take("opacity", first, count, [&](size_t i, double value) { g.opacities[i] = opacity_of_logit(value); });
    if (!status) return status;
    if (status = read_rotations(first, count, g); !status) return status;
    return read_harmonics(first, count, g);
  }

  /// rot_0 is w.
  Status read_rotations(uint64_t first, uint64_t count, Gaussians& g) {
    static constexpr std::array<float glm::quat::*, 4> kParts = {&glm::quat::w, &glm::quat::x, &glm::quat::y,
                                                                 &glm::quat::z};
    for (size_t part = 0; part < kParts.size(); ++part) {
      Status status = take("rot_" + std::to_string(part), first, count,
                           [&](size_t i, double value) { g.rotations[i].*kParts[part] = static_cast<float>(value); });
      if (!status) return status;
    }
    return {};
  }

  Status read_harmonics(uint64_t first, uint64_t count, Gaussians& g) {
    const size_t width = harmonics_of(traits_.degree) * 3;
    const auto fill = [&](const std::string& name, size_t place) {
      return take(name, first, count,
                  [&](size_t i, double value) { g.harmonics[i * width + place] = static_cast<float>(value); });
    };
    for (size_t channel = 0; channel < 3; ++channel) {
      if (Status status = fill("f_dc_" + std::to_string(channel), channel); !status) return status;
    }
    for (size_t k = 0; k < width - 3; ++k) {
      Status status = fill("f_rest_" + std::to_string(k), place_of_rest(k, traits_.degree));
      if (!status) return status;
    }
    return {};
  }

  PlyColumns columns_;
  GaussianTraits traits_;
};

/// The ranges of a chunk of vertices: minima and maxima of position, logarithm of scale, and colour.
struct Chunk {
  std::array<glm::vec3, 3> min{glm::vec3(0), glm::vec3(0), glm::vec3(0)};
  std::array<glm::vec3, 3> max{glm::vec3(0), glm::vec3(0), glm::vec3(1)};
};

constexpr uint64_t kChunkSize = 256;

/// Colours without ranges are from 0 to 1.
Result<std::vector<Chunk>> read_chunks(PlyColumns& columns, uint64_t count) {
  static constexpr const char* kNames[3][3] = {{"x", "y", "z"}, {"scale_x", "scale_y", "scale_z"}, {"r", "g", "b"}};
  std::vector<Chunk> chunks(count);
  for (size_t group = 0; group < 3; ++group) {
    if (group == 2 && !columns.has("min_r")) continue;
    for (int axis = 0; axis < 3; ++axis) {
      for (const bool max : {false, true}) {
        const std::string name = (max ? "max_" : "min_") + std::string(kNames[group][axis]);
        if (!columns.has(name)) return fail(ErrorKind::kInvalidInput, "chunks without the property " + name);
        Status status = columns.for_each<float>(
            name, 0, count, [&](size_t i, float value) { (max ? chunks[i].max : chunks[i].min)[group][axis] = value; });
        if (!status) return fail(status);
      }
    }
  }
  return chunks;
}

/// In double precision, so that positions are rounded once.
glm::dvec3 between(const glm::vec3& min, const glm::vec3& max, const glm::dvec3& t) {
  return glm::dvec3(min) * (1.0 - t) + glm::dvec3(max) * t;
}

/// 11, 10 and 11 bits, x highest, as fractions.
glm::dvec3 unpack_11_10_11(uint32_t bits) {
  return {(bits >> 21) / 2047.0, (bits >> 11 & 1023) / 1023.0, (bits & 2047) / 2047.0};
}

/// Two bits say which of w x y z is left out; the others follow in that order, ten bits each.
glm::quat unpack_rotation(uint32_t bits) {
  const uint32_t left_out = bits >> 30;
  std::array<float, 4> wxyz{};
  double rest = 1;
  int shift = 20;
  for (uint32_t i = 0; i < 4; ++i) {
    if (i == left_out) continue;
    const double value = ((bits >> shift & 1023) / 1023.0 - 0.5) * std::sqrt(2.0);
    wxyz[i] = static_cast<float>(value);
    rest -= value * value;
    shift -= 10;
  }
  wxyz[left_out] = static_cast<float>(std::sqrt(std::max(0.0, rest)));
  return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]};
}

/// Bytes are the middles of 256 steps from -4 to 4; the first and the last are the ends.
float unpack_harmonic(uint32_t byte) {
  if (byte == 0) return -4;
  if (byte == 255) return 4;
  return static_cast<float>(((byte + 0.5) / 256 - 0.5) * 8);
}

class CompressedPly final : public GaussianSource {
 public:
  CompressedPly(PlyColumns vertices, std::optional<PlyColumns> harmonics, std::vector<Chunk> chunks,
                GaussianTraits traits)
      : vertices_(std::move(vertices)),
        harmonics_(std::move(harmonics)),
        chunks_(std::move(chunks)),
        traits_(std::move(traits)) {}

  [[nodiscard]] const GaussianTraits& traits() const override { return traits_; }
  [[nodiscard]] uint64_t held_bytes() const override { return chunks_.size() * sizeof(Chunk); }

  Result<Gaussians> read(uint64_t first, uint64_t count) override {
    Gaussians gaussians = make_gaussians(count, traits_.degree);
    if (Status status = read_vertices(first, count, gaussians); !status) return fail(status);
    if (Status status = read_harmonics(first, count, gaussians); !status) return fail(status);
    return gaussians;
  }

 private:
  Status read_vertices(uint64_t first, uint64_t count, Gaussians& g) {
    const size_t width = harmonics_of(traits_.degree) * 3;
    const auto chunk = [&](size_t i) -> const Chunk& { return chunks_[(first + i) / kChunkSize]; };
    const auto take = [&](const char* name, auto&& use) {
      return vertices_.for_each<uint32_t>(name, first, count, use);
    };
    Status status = take("packed_position", [&](size_t i, uint32_t bits) {
      const glm::dvec3 position = between(chunk(i).min[0], chunk(i).max[0], unpack_11_10_11(bits));
      for (int axis = 0; axis < 3; ++axis) g.positions[i][axis] = rounded_to_float(position[axis]);
    });
    if (!status) return status;
    status = take("packed_scale", [&](size_t i, uint32_t bits) {
      g.scales[i] = glm::exp(between(chunk(i).min[1], chunk(i).max[1], unpack_11_10_11(bits)));
    });
    if (!status) return status;
    status = take("packed_rotation", [&](size_t i, uint32_t bits) { g.rotations[i] = unpack_rotation(bits); });
    if (!status) return status;
    return take("packed_color", [&](size_t i, uint32_t bits) {
      const glm::dvec3 t(bits >> 24, bits >> 16 & 255, bits >> 8 & 255);
      const glm::dvec3 color = between(chunk(i).min[2], chunk(i).max[2], t / 255.0);
      for (int channel = 0; channel < 3; ++channel) {
        g.harmonics[i * width + static_cast<size_t>(channel)] = coefficient_of(color[channel]);
      }
      g.opacities[i] = static_cast<float>(bits & 255) / 255.0F;
    });
  }

  Status read_harmonics(uint64_t first, uint64_t count, Gaussians& g) {
    const size_t width = harmonics_of(traits_.degree) * 3;
    for (size_t k = 0; k < width - 3; ++k) {
      const size_t place = place_of_rest(k, traits_.degree);
      Status status = harmonics_->for_each<uint32_t>(
          "f_rest_" + std::to_string(k), first, count,
          [&](size_t i, uint32_t byte) { g.harmonics[i * width + place] = unpack_harmonic(byte); });
      if (!status) return status;
    }
    return {};
  }

  PlyColumns vertices_;
  std::optional<PlyColumns> harmonics_;
  std::vector<Chunk> chunks_;
  GaussianTraits traits_;
};

/// Fails if a column is missing.
Status require(const PlyColumns& columns, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (!columns.has(name)) {
      return fail(ErrorKind::kInvalidInput, std::string("3D Gaussians without the property ") + name);
    }
  }
  return {};
}

/// Packed words must be integers: a float that is none would not fit.
Status require_type(const PlyColumns& columns, const std::string& name, scan::ScalarType type) {
  if (columns.type(name) == type) return {};
  return fail(ErrorKind::kInvalidInput, "compressed PLY: the property " + name + " has the wrong type");
}

Result<std::vector<Chunk>> open_chunks(const stream::FilePtr& file, const scan::PlyHeader& header, uint64_t vertices) {
  const scan::PlyElement* element = find_element(header, "chunk");
  const uint64_t wanted = (vertices + kChunkSize - 1) / kChunkSize;
  if (element == nullptr || element->count < wanted) {
    return fail(ErrorKind::kInvalidInput,
                "compressed PLY with fewer chunks than its " + std::to_string(vertices) + " vertices need");
  }
  Result<PlyColumns> columns = PlyColumns::open(file, "chunk");
  if (!columns) return fail(columns);
  return read_chunks(*columns, wanted);
}

/// The element "sh", if there is one; its degree goes into the traits.
Result<std::optional<PlyColumns>> open_harmonics(const stream::FilePtr& file, const scan::PlyHeader& header,
                                                 GaussianTraits& traits) {
  const scan::PlyElement* element = find_element(header, "sh");
  if (element == nullptr) return std::nullopt;
  if (element->count < traits.count) {
    return fail(ErrorKind::kInvalidInput, "compressed PLY with fewer harmonics than vertices");
  }
  Result<PlyColumns> columns = PlyColumns::open(file, "sh");
  if (!columns) return fail(columns);
  const Result<int> degree = degree_of_rest(*columns);
  if (!degree) return fail(degree);
  traits.degree = *degree;
  for (size_t k = 0; k < count_rest(*columns); ++k) {
    Status status = require_type(*columns, "f_rest_" + std::to_string(k), scan::ScalarType::kUint8);
    if (!status) return fail(status);
  }
  return std::optional(std::move(*columns));
}

}  // namespace

PlyKind ply_kind_of(std::span<const std::byte> bytes) {
  const Result<scan::PlyHeader> header = scan::parse_ply_header(bytes);
  const scan::PlyElement* vertex = header ? find_element(*header, "vertex") : nullptr;
  if (vertex == nullptr) return PlyKind::kOther;
  if (has_property(*vertex, "packed_position")) return PlyKind::kCompressed;
  return has_property(*vertex, "f_dc_0") ? PlyKind::kFloats : PlyKind::kOther;
}

Result<SourcePtr> open_ply(const stream::FilePtr& file) {
  GaussianTraits traits;
  const Result<uint64_t> count = vertex_count(file);
  if (!count) return fail(count);
  traits.count = *count;
  Result<PlyColumns> columns = PlyColumns::open(file, "vertex");
  if (!columns) return fail(columns);
  Status status = require(*columns, {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1",
                                     "rot_0", "rot_1", "rot_2", "rot_3"});
  if (!status) return fail(status);
  const Result<int> degree = degree_of_rest(*columns);
  if (!degree) return fail(degree);
  traits.degree = *degree;
  traits.flat = !columns->has("scale_2");
  traits.format = traits.flat ? "2DGS PLY" : "3DGS PLY";
  return std::make_unique<PlyGaussians>(std::move(*columns), std::move(traits));
}

Result<SourcePtr> open_compressed_ply(const stream::FilePtr& file) {
  GaussianTraits traits;
  traits.format = "compressed PLY";
  const Result<scan::PlyHeader> header = scan::parse_ply_header(file->bytes());
  const Result<uint64_t> count = vertex_count(file);
  if (!header || !count) return fail(header ? count.error() : header.error());
  traits.count = *count;
  Result<PlyColumns> vertices = PlyColumns::open(file, "vertex");
  if (!vertices) return fail(vertices);
  Status status = require(*vertices, {"packed_position", "packed_rotation", "packed_scale", "packed_color"});
  if (!status) return fail(status);
  for (const char* name : {"packed_position", "packed_rotation", "packed_scale", "packed_color"}) {
    if (status = require_type(*vertices, name, scan::ScalarType::kUint32); !status) return fail(status);
  }
  Result<std::vector<Chunk>> chunks = open_chunks(file, *header, traits.count);
  if (!chunks) return fail(chunks);
  Result<std::optional<PlyColumns>> harmonics = open_harmonics(file, *header, traits);
  if (!harmonics) return fail(harmonics);
  return std::make_unique<CompressedPly>(std::move(*vertices), std::move(*harmonics), std::move(*chunks),
                                         std::move(traits));
}

}  // namespace surfcast::gaussian
