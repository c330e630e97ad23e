#include "colorize/paint_scan.h"

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace surfcast::colorize {
namespace {

using scan::ScalarType;
using scan::ScanPoints;

/// sRGB, the grey in which models without colours are drawn (kGrey of shaders/include/resolve.glsl).
constexpr uint8_t kGrey = 231;

/// How many points each Paint has; all threads add to it.
using Counts = std::array<std::atomic<uint64_t>, 3>;

/// The columns of a scan's points, with colours.
std::vector<scan::ColumnInfo> columns_of(const scan::ScanSchema& schema) {
  std::vector<scan::ColumnInfo> columns;
  for (const char* name : {"x", "y", "z"}) columns.push_back({name, ScalarType::kFloat64, false});
  if (schema.normals) {
    for (const char* name : {"nx", "ny", "nz"}) columns.push_back({name, ScalarType::kFloat32, false});
  }
  if (schema.radii) columns.push_back({"radius", ScalarType::kFloat32, false});
  for (const char* name : {"red", "green", "blue"}) columns.push_back({name, ScalarType::kUint8, false});
  for (const scan::ScalarField& field : schema.scalars) columns.push_back({field.name, field.type, false});
  return columns;
}

template <typename Vectors>
void add_axes(const Vectors& vectors, scan::PointTable& table) {
  using Value = typename Vectors::value_type::value_type;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Value> values;
    values.reserve(vectors.size());
    for (const auto& vector : vectors) values.push_back(vector[axis]);
    add_column(table, surfel::ScalarValues(std::move(values)));
  }
}

/// Colours of 8 bits; grey without any.
std::vector<glm::u8vec3> own_colors(const ScanPoints& points) {
  std::vector<glm::u8vec3> colors(points.size(), glm::u8vec3(kGrey));
  if (!points.colors) return colors;
  const unsigned most = points.colors->bits == 8 ? 255 : 65535;
  for (size_t i = 0; i < colors.size(); ++i) {
    colors[i] = glm::u8vec3((glm::uvec3(points.colors->values[i]) * 255U + most / 2) / most);
  }
  return colors;
}

class PaintedRows : public scan::RowSource {
 public:
  PaintedRows(scan::ScanStream scan, Painter painter, std::shared_ptr<Counts> counts)
      : scan_(std::move(scan)),
        painter_(std::move(painter)),
        counts_(std::move(counts)),
        columns_(columns_of(scan_.schema())) {
    const scan::ScanSchema& schema = scan_.schema();
    traits_.grid = schema.grid;
    traits_.sensor = schema.sensor;
    traits_.z_up = schema.z_up;
    traits_.surface_step = schema.surface_step;
    traits_.exact_radii = schema.exact_radii;
    traits_.two_sided = schema.two_sided;
  }

  [[nodiscard]] const scan::RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<scan::ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return scan_.pieces(); }
  [[nodiscard]] uint64_t held_bytes() const override { return scan_.held_bytes(); }
  [[nodiscard]] Result<scan::PointTable> read(size_t piece) const override;

 private:
  scan::ScanStream scan_;
  Painter painter_;
  std::shared_ptr<Counts> counts_;
  scan::RowTraits traits_;
  std::vector<scan::ColumnInfo> columns_;
};

Result<scan::PointTable> PaintedRows::read(size_t piece) const {
  Result<ScanPoints> points = scan_.read(piece);
  if (!points) return fail(points);
  std::vector<glm::u8vec3> colors = own_colors(*points);
  for (size_t i = 0; i < colors.size(); ++i) {
    ++(*counts_)[static_cast<size_t>(painter_(points->positions[i], colors[i]))];
  }
  scan::PointTable table;
  table.rows = points->size();
  add_axes(points->positions, table);
  if (scan_.schema().normals) add_axes(points->normals, table);
  if (scan_.schema().radii) add_column(table, surfel::ScalarValues(std::move(points->radii)));
  add_axes(colors, table);
  for (surfel::ScalarAttribute& scalar : points->scalars) add_column(table, std::move(scalar.values));
  return table;
}

}  // namespace

Result<scan::ScanStream> paint_scan(scan::ScanStream scan, const std::filesystem::path& path, Painter painter,
                                    std::optional<uint64_t> sample, PaintReport& report) {
  const auto counts = std::make_shared<Counts>();
  Result<scan::ScanStream> made = scan::ScanStream::of_rows(
      std::make_unique<PaintedRows>(std::move(scan), std::move(painter), counts), path, sample);
  if (!made) return made;
  const auto count = [&](Paint paint) { return (*counts)[static_cast<size_t>(paint)].load(); };
  if (count(Paint::kPainted) == 0) {
    return fail(ErrorKind::kInvalidInput, path.string() + ": none of its points lies in the picture");
  }
  report.painted += count(Paint::kPainted);  // opening has read every point once
  report.hidden += count(Paint::kHidden);
  report.outside += count(Paint::kOutside);
  return made;
}

}  // namespace surfcast::colorize
