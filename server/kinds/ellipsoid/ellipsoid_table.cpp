#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

#include "ellipsoid/input_formats.h"
#include "ellipsoid/shape_columns.h"
#include "ellipsoid/table_columns.h"
#include "scan/ply_header.h"
#include "scan/readers.h"
#include "scan/scan_stream.h"
#include "scan/text_tokens.h"

namespace surfcast::ellipsoid {
namespace {

constexpr const char* kShapePrefix = "shape of an ellipsoid ";

/// The names under which the columns of a shape are read, by their places in ShapeRoles::all.
std::string shape_name(size_t i) {
  return kShapePrefix + std::to_string(i);
}

/// Rows of a file whose columns of the shape have names of their own: "b" is not taken for blue.
class TableRows final : public scan::RowSource {
 public:
  TableRows(stream::FilePtr file, std::unique_ptr<scan::RowSource> rows, const std::vector<size_t>& shape)
      : file_(std::move(file)), rows_(std::move(rows)), columns_(rows_->columns()) {
    for (size_t i = 0; i < shape.size(); ++i) columns_[shape[i]].name = shape_name(i);
  }

  [[nodiscard]] const scan::RowTraits& traits() const override { return rows_->traits(); }
  [[nodiscard]] const std::vector<scan::ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return rows_->pieces(); }
  [[nodiscard]] Result<scan::PointTable> read(size_t piece) const override { return rows_->read(piece); }
  [[nodiscard]] uint64_t held_bytes() const override { return rows_->held_bytes(); }

 private:
  stream::FilePtr file_;
  std::unique_ptr<scan::RowSource> rows_;
  std::vector<scan::ColumnInfo> columns_;
};

bool is_ply(const stream::FilePtr& file) {
  return scan::as_text(file->bytes()).starts_with("ply");
}

std::vector<double> as_doubles(const surfel::ScalarValues& values) {
  return std::visit([](const auto& typed) { return std::vector<double>(typed.begin(), typed.end()); }, values);
}

/// From a rotation matrix; of an improper one the third axis is turned, which gives the same ellipsoid.
glm::dquat rotation_of(const std::array<double, 9>& rows) {
  glm::dmat3 axes;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      axes[column][row] = rows.at(static_cast<size_t>(row) * 3 + static_cast<size_t>(column));
    }
  }
  if (glm::determinant(axes) < 0) axes[2] = -axes[2];
  return glm::quat_cast(axes);
}

class EllipsoidTable final : public EllipsoidInput {
 public:
  EllipsoidTable(stream::FilePtr file, scan::ScanStream stream, ShapeRoles roles)
      : file_(std::move(file)), stream_(std::move(stream)), roles_(std::move(roles)) {
    facts_.name = stream_.schema().name;
    facts_.tensors = !roles_.tensor.empty();
    constexpr auto kDouble = static_cast<uint8_t>(scan::ScalarType::kFloat64);
    for (const char* derived : {"fa", "mode", "md"}) facts_.attributes.push_back({derived, kDouble, 0, 0});
    for (const scan::ScalarField& field : stream_.schema().scalars) {
      if (is_shape(field.name)) continue;
      facts_.attributes.push_back({field.name, static_cast<uint8_t>(field.type), 0, 0});
    }
  }

  [[nodiscard]] const model::EllipsoidSource& facts() const override { return facts_; }
  [[nodiscard]] uint64_t samples() const override { return stream_.size(); }
  [[nodiscard]] uint64_t samples_of_file() const override { return stream_.size_of_file(); }
  [[nodiscard]] bool z_up() const override { return stream_.schema().z_up; }
  [[nodiscard]] bool has_colors() const override { return stream_.schema().color_bits > 0; }
  [[nodiscard]] uint64_t held_bytes() const override { return stream_.held_bytes(); }
  [[nodiscard]] bool at_end() const override { return piece_ == stream_.pieces(); }
  Status rewind() override {
    piece_ = 0;
    return {};
  }

  Result<Ellipsoids> read(model::EllipsoidCounts& counts) override {
    const Result<scan::ScanPoints> points = stream_.read(piece_++);
    if (!points) return fail(points);
    file_->release_pages();
    const std::vector<std::vector<double>> columns = shape_columns(*points);
    ShapeColumns shapes = roles_.tensor.empty() ? shapes_of(axes_samples(*points, columns), counts)
                                                : shapes_of(tensor_samples(*points, columns), counts);
    add_colors(*points, shapes);
    add_scalars(*points, shapes);
    return std::move(shapes.ellipsoids);
  }

 private:
  static bool is_shape(const std::string& name) { return name.starts_with(kShapePrefix); }

  /// The columns of the shape in the order of ShapeRoles::all.
  [[nodiscard]] std::vector<std::vector<double>> shape_columns(const scan::ScanPoints& points) const {
    std::vector<std::vector<double>> columns(roles_.all().size());
    for (size_t i = 0; i < columns.size(); ++i) {
      for (const surfel::ScalarAttribute& scalar : points.scalars) {
        if (scalar.name == shape_name(i)) columns[i] = as_doubles(scalar.values);
      }
    }
    return columns;
  }

  [[nodiscard]] static std::vector<TensorSample> tensor_samples(const scan::ScanPoints& points,
                                                                const std::vector<std::vector<double>>& c) {
    std::vector<TensorSample> samples(points.size());
    for (size_t i = 0; i < samples.size(); ++i) {
      samples[i].position = points.positions[i];
      samples[i].tensor = {c[0][i], c[1][i], c[2][i], c[3][i], c[4][i], c[5][i]};
    }
    return samples;
  }

  [[nodiscard]] std::vector<AxesSample> axes_samples(const scan::ScanPoints& points,
                                                     const std::vector<std::vector<double>>& c) const {
    std::vector<AxesSample> samples(points.size());
    for (size_t i = 0; i < samples.size(); ++i) {
      samples[i].position = points.positions[i];
      samples[i].semi_axes = {c[0][i], c[1][i], c[2][i]};
      if (!roles_.quaternion.empty()) samples[i].rotation = glm::dquat(c[3][i], c[4][i], c[5][i], c[6][i]);
      if (roles_.matrix.empty()) continue;
      std::array<double, 9> rows{};
      for (size_t k = 0; k < rows.size(); ++k) rows.at(k) = c[3 + k][i];
      samples[i].rotation = rotation_of(rows);
    }
    return samples;
  }

  void add_colors(const scan::ScanPoints& points, ShapeColumns& shapes) const {
    if (!points.colors) return;
    const int shift = points.colors->bits - 8;
    for (const uint32_t row : shapes.rows) {
      const glm::u16vec3& color = points.colors->values[row];
      shapes.ellipsoids.colors.emplace_back(color.r >> shift, color.g >> shift, color.b >> shift);
    }
  }

  static void add_scalars(const scan::ScanPoints& points, ShapeColumns& shapes) {
    for (const surfel::ScalarAttribute& scalar : points.scalars) {
      if (is_shape(scalar.name)) continue;
      shapes.ellipsoids.scalars.push_back({scalar.name, chosen(scalar.values, shapes.rows)});
    }
  }

  static surfel::ScalarValues chosen(const surfel::ScalarValues& values, const std::vector<uint32_t>& rows) {
    return std::visit(
        [&](const auto& all) -> surfel::ScalarValues {
          std::decay_t<decltype(all)> some;
          some.reserve(rows.size());
          for (const uint32_t row : rows) some.push_back(all[row]);
          return some;
        },
        values);
  }

  stream::FilePtr file_;
  scan::ScanStream stream_;
  ShapeRoles roles_;
  model::EllipsoidSource facts_;
  size_t piece_ = 0;
};

}  // namespace

std::vector<std::string> table_columns(const stream::FilePtr& file) {
  if (!is_ply(file)) return scan::text_column_names(scan::as_text(file->bytes()));
  const Result<scan::PlyHeader> header = scan::parse_ply_header(file->bytes());
  if (!header) return {};
  for (const scan::PlyElement& element : header->elements) {
    if (element.name != "vertex") continue;
    std::vector<std::string> names;
    for (const scan::PlyProperty& property : element.properties) {
      if (!property.list_count) names.push_back(property.name);
    }
    return names;
  }
  return {};
}

bool is_ellipsoid_table(const stream::FilePtr& file, bool asked) {
  const std::optional<ShapeRoles> roles = shape_roles(table_columns(file));
  return roles && (asked || roles->rotated() || !roles->tensor.empty());
}

Result<InputPtr> open_table(const stream::FilePtr& file, const std::filesystem::path& path,
                            const InputOptions& options) {
  const auto named = [&path](const Error& error) { return fail(error.kind, path.string() + ": " + error.message); };
  Result<std::unique_ptr<scan::RowSource>> rows =
      is_ply(file) ? scan::ply_rows(file->bytes()) : scan::text_rows(file->bytes());
  if (!rows) return named(rows.error());
  std::vector<std::string> names;
  for (const scan::ColumnInfo& column : (*rows)->columns()) names.push_back(column.name);
  std::optional<ShapeRoles> roles = shape_roles(names);
  if (!roles) return named({ErrorKind::kUnsupported, "has no columns of semi-axes or of a tensor"});
  auto renamed = std::make_unique<TableRows>(file, std::move(*rows), roles->all());
  Result<scan::ScanStream> stream = scan::ScanStream::of_rows(std::move(renamed), path, options.sample);
  if (!stream) return fail(stream);
  if (Status fits = options.limit.check(stream->held_bytes()); !fits) return named(fits.error());
  return std::make_unique<EllipsoidTable>(file, std::move(*stream), std::move(*roles));
}

}  // namespace surfcast::ellipsoid
