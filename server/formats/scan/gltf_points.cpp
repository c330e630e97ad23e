#include "scan/gltf_points.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>

#include "base/ascii_text.h"
#include "base/invalid_input.h"
#include "scan/gltf_primitive.h"
#include "scan/gltf_scene.h"
#include "scan/move_points.h"
#include "scan/sliced_rows.h"
#include "scan/text_tokens.h"
#include "surfel/srgb.h"

namespace surfcast::scan {
namespace {

using Triples = std::vector<glm::dvec3>;

/// Extensions of images, which points do not have, and of centres.
constexpr std::array<std::string_view, 4> kHarmless{"EXT_texture_webp", "KHR_texture_basisu", "KHR_texture_transform",
                                                    "CESIUM_RTC"};

/// Points that a byte of Draco data, or of points with many instances, may stand for.
constexpr uint64_t kMaxPointsOfByte = 64;

ScalarType type_of_accessor(const Json& accessor) {
  const uint64_t stated = integer_of(accessor, "componentType").value_or(0);
  if (flag_of(accessor, "normalized")) return ScalarType::kFloat32;
  switch (stated) {
    case kGltfInt8:
      return ScalarType::kInt8;
    case kGltfUint8:
      return ScalarType::kUint8;
    case kGltfInt16:
      return ScalarType::kInt16;
    case kGltfUint16:
      return ScalarType::kUint16;
    case kGltfUint32:
      return ScalarType::kUint32;
    default:
      return ScalarType::kFloat32;
  }
}

glm::vec3 factor_of(const Json& json, const Json& primitive) {
  const std::optional<uint64_t> number = integer_of(primitive, "material");
  if (!number) return glm::vec3(1);
  const Json& material = element(member(json, "materials"), *number);
  const auto factor = numbers_of(member(material, "pbrMetallicRoughness"), "baseColorFactor", 4);
  return factor ? glm::vec3((*factor)[0], (*factor)[1], (*factor)[2]) : glm::vec3(1);
}

/// The name of the column of an attribute of an application, without its underscore unless it would be taken for the
/// position, the colour or the normal.
std::string scalar_name(const std::string& attribute) {
  constexpr std::array<std::string_view, 9> kTaken{"x", "y", "z", "red", "green", "blue", "nx", "ny", "nz"};
  const std::string name = to_lower(printable(std::string_view(attribute).substr(1)));
  return std::find(kTaken.begin(), kTaken.end(), name) == kTaken.end() ? name : "_" + name;
}

bool is_scalar_of_application(const std::string& attribute, const Json& accessor) {
  return attribute.size() > 1 && attribute.front() == '_' && text_of(accessor, "type") == "SCALAR";
}

/// The nearest number of a type. Draco data may hold others than their accessor states.
template <typename T>
T nearest(double value) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(value);
  } else {
    if (!(value > static_cast<double>(std::numeric_limits<T>::min()))) return std::numeric_limits<T>::min();
    return value < static_cast<double>(std::numeric_limits<T>::max()) ? static_cast<T>(value)
                                                                      : std::numeric_limits<T>::max();
  }
}

/// The rows of a table while parts of a scene are added.
class SceneRows {
 public:
  explicit SceneRows(const std::vector<ColumnInfo>& columns) {
    for (const ColumnInfo& column : columns) columns_.push_back(empty_values(column.type));
  }

  template <typename Value>
  void add(size_t column, size_t rows, const Value& value_of) {
    std::visit(
        [&](auto& values) {
          using T = typename std::decay_t<decltype(values)>::value_type;
          for (size_t i = 0; i < rows; ++i) values.push_back(nearest<T>(static_cast<double>(value_of(i))));
        },
        columns_[column]);
  }
  void add_triples(size_t column, const Triples& triples) {
    for (int axis = 0; axis < 3; ++axis) {
      add(column + static_cast<size_t>(axis), triples.size(), [&](size_t i) { return triples[i][axis]; });
    }
  }

  PointTable take(size_t rows) {
    PointTable table;
    table.rows = rows;
    for (surfel::ScalarValues& values : columns_) add_column(table, std::move(values));
    return table;
  }

 private:
  std::vector<surfel::ScalarValues> columns_;
};

/// An attribute of a primitive, by the rows that its indices make.
class RowValues {
 public:
  RowValues(const PrimitiveValues& primitive, const std::string& name) : indices_(primitive.indices) {
    const auto found = primitive.attributes.find(name);
    const size_t vertices = primitive.attributes.at("POSITION").count();
    if (found != primitive.attributes.end() && found->second.count() == vertices) values_ = &found->second;
  }

  [[nodiscard]] bool there() const { return values_ != nullptr; }
  [[nodiscard]] size_t rows() const { return indices_.size(); }
  /// Zero beyond the components.
  [[nodiscard]] double at(size_t row, size_t component) const {
    return component < values_->components ? values_->values[indices_[row] * values_->components + component] : 0;
  }
  [[nodiscard]] Triples triples() const {
    Triples made(there() ? rows() : 0);
    for (size_t i = 0; i < made.size(); ++i) made[i] = {at(i, 0), at(i, 1), at(i, 2)};
    return made;
  }

 private:
  const std::vector<uint32_t>& indices_;
  const AccessorValues* values_ = nullptr;
};

/// Linear light becomes sRGB. Without colours the factor is the colour.
void add_colors(const RowValues& colors, const glm::vec3& factor, int bits, size_t column, SceneRows& rows) {
  std::vector<glm::u16vec3> made(colors.rows());
  for (size_t i = 0; i < made.size(); ++i) {
    const glm::vec3 light =
        colors.there() ? glm::vec3(colors.at(i, 0), colors.at(i, 1), colors.at(i, 2)) : glm::vec3(1);
    made[i] = surfel::from_linear(light * factor, bits);
  }
  for (int channel = 0; channel < 3; ++channel) {
    rows.add(column + static_cast<size_t>(channel), made.size(), [&](size_t i) { return made[i][channel]; });
  }
}

}  // namespace

GltfPoints::GltfPoints(GltfParts parts, GltfBuffers buffers)
    : parts_(std::make_unique<const GltfParts>(std::move(parts))), buffers_(std::move(buffers)) {
  const Json& relative = member(member(parts_->json, "extensions"), "CESIUM_RTC");
  if (const auto centre = numbers_of(relative, "center", 3)) centre_ = {(*centre)[0], (*centre)[1], (*centre)[2]};
}

Result<GltfPoints> GltfPoints::open(std::span<const std::byte> bytes, const std::filesystem::path& path,
                                    const DecodingLimit& limit) {
  Result<GltfParts> parts = split_gltf(bytes);
  if (!parts) return fail(parts);
  if (Status status = check_gltf_extensions(parts->json, kHarmless); !status) return fail(status);
  Result<GltfBuffers> buffers = GltfBuffers::open(path, *parts, limit);
  if (!buffers) return fail(buffers);
  GltfPoints points(std::move(*parts), std::move(*buffers));
  const auto add = [&points](const Json& node, const glm::dmat4& to_world) { return points.add_node(node, to_world); };
  if (Status status = visit_gltf_nodes(points.parts_->json, add); !status) return fail(status);
  points.find_columns();
  return points;
}

Status GltfPoints::add_node(const Json& node, const glm::dmat4& to_world) {
  const std::optional<uint64_t> number = integer_of(node, "mesh");
  if (!number) return {};
  for (const Json& stated : member(element(member(parts_->json, "meshes"), *number), "primitives")) {
    if (gltf_mode(stated) != kGltfPoints) {
      others_ = true;
    } else if (Status status = add_primitive(stated, to_world); !status) {
      return status;
    }
  }
  return {};
}

const Json& GltfPoints::accessor_of(const Json& stated, const std::string& attribute) const {
  const uint64_t number = integer_of(member(stated, "attributes"), attribute.c_str()).value_or(UINT64_MAX);
  return element(member(parts_->json, "accessors"), number);
}

Status GltfPoints::add_primitive(const Json& stated, const glm::dmat4& to_world) {
  const bool packed = member(member(stated, "extensions"), kDracoExtension).is_object();
  const std::optional<uint64_t> indices = packed ? std::nullopt : integer_of(stated, "indices");
  const Json& counted =
      indices ? element(member(parts_->json, "accessors"), *indices) : accessor_of(stated, "POSITION");
  const uint64_t points = integer_of(counted, "count").value_or(0);
  const uint64_t most = buffers_.bytes() * kMaxPointsOfByte;
  if (points > (packed ? most : buffers_.bytes()) || points_ + points > most) {
    return invalid_input("states more points than its buffers can hold");
  }
  points_ += points;
  if (points > 0) scene_.push_back({&stated, to_world, points, factor_of(parts_->json, stated)});
  return {};
}

void GltfPoints::find_columns() {
  std::vector<ColumnInfo> scalars;
  for (const Part& part : scene_) {
    const Json& color = accessor_of(*part.stated, "COLOR_0");
    const bool plain = part.factor == glm::vec3(1);
    const bool bytes = plain && integer_of(color, "componentType") == kGltfUint8;
    if (color.is_object() || !plain) color_bits_ = std::max(color_bits_, bytes ? 8 : 16);
    normals_ = normals_ || accessor_of(*part.stated, "NORMAL").is_object();
    for (const auto& [name, number] : member(*part.stated, "attributes").items()) {
      const Json& accessor = accessor_of(*part.stated, name);
      const bool known = std::find(scalars_.begin(), scalars_.end(), name) != scalars_.end();
      if (known || !is_scalar_of_application(name, accessor)) continue;
      scalars_.push_back(name);
      scalars.push_back({scalar_name(name), type_of_accessor(accessor), false});
    }
  }
  if (scene_.empty()) return;
  const ScalarType channel = color_bits_ == 8 ? ScalarType::kUint8 : ScalarType::kUint16;
  const auto add = [this](const std::array<const char*, 3>& names, ScalarType type) {
    for (const char* name : names) columns_.push_back({name, type, false});
  };
  add({"x", "y", "z"}, ScalarType::kFloat64);
  if (color_bits_ > 0) add({"red", "green", "blue"}, channel);
  if (normals_) add({"nx", "ny", "nz"}, ScalarType::kFloat32);
  columns_.insert(columns_.end(), scalars.begin(), scalars.end());
}

Result<PointTable> GltfPoints::table(const glm::dmat4& transform) const {
  std::vector<std::string> wanted{"POSITION", "NORMAL", "COLOR_0"};
  wanted.insert(wanted.end(), scalars_.begin(), scalars_.end());
  GltfBuffers buffers = buffers_;  // counts the memory of this call
  SceneRows rows(columns_);
  for (const Part& part : scene_) {
    const Result<PrimitiveValues> values = read_gltf_primitive(parts_->json, *part.stated, wanted, buffers);
    if (!values) return fail(values);
    if (values->indices.size() != part.points) return invalid_input("has not the points that its accessors state");
    const glm::dmat4 to_world = transform * part.to_world;
    Triples positions = RowValues(*values, "POSITION").triples();
    move_points(to_world, positions);
    rows.add_triples(0, positions);
    size_t column = 3;
    if (color_bits_ > 0) add_colors(RowValues(*values, "COLOR_0"), part.factor, color_bits_, column, rows);
    column += color_bits_ > 0 ? 3 : 0;
    if (normals_) {
      Triples normals = RowValues(*values, "NORMAL").triples();
      normals.resize(positions.size());
      turn_normals(to_world, normals);
      rows.add_triples(column, normals);
      column += 3;
    }
    for (const std::string& name : scalars_) {
      const RowValues scalar(*values, name);
      rows.add(column++, positions.size(), [&](size_t i) { return scalar.there() ? scalar.at(i, 0) : 0; });
    }
  }
  return rows.take(static_cast<size_t>(points_));
}

glm::dmat4 y_up_to_z_up() {
  return {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}, {0, 0, 0, 1}};
}

bool is_gltf_of_points(std::span<const std::byte> bytes) {
  const Result<GltfParts> parts = split_gltf(bytes);
  if (!parts) return false;
  bool points = false;
  for (const Json& mesh : member(parts->json, "meshes")) {
    for (const Json& primitive : member(mesh, "primitives")) {
      const uint64_t mode = gltf_mode(primitive);
      if (mode > 3) return false;
      points = points || mode == kGltfPoints;
    }
  }
  return points;
}

Result<std::unique_ptr<RowSource>> gltf_rows(std::span<const std::byte> bytes, const std::filesystem::path& path,
                                             const DecodingLimit& limit) {
  const Result<GltfPoints> points = GltfPoints::open(bytes, path, limit);
  if (!points) return fail(points);
  if (points->points() == 0) return fail(ErrorKind::kUnsupported, "is a glTF file without points");
  RowTraits traits;
  traits.z_up = points->centre().has_value();
  glm::dmat4 transform(1);
  if (points->centre()) {
    transform = y_up_to_z_up();
    transform[3] = glm::dvec4(*points->centre(), 1);
  }
  Result<PointTable> table = points->table(transform);
  if (!table) return fail(table);
  if (points->others()) traits.notes.emplace_back("triangles and lines beside its points are left out");
  return std::make_unique<SlicedRows>(traits, points->columns(), std::move(*table));
}

}  // namespace surfcast::scan
