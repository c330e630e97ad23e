#include "exporter/model_points.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "crs/transformation.h"
#include "exporter/source_system.h"
#include "model/georeference.h"

namespace surfcast::exporter {
namespace {

constexpr std::string_view kClassName = "classification";

bool has_points(const model::ModelFile& model, const ldc::BlockEntry& block) {
  return model.info().kinds[block.kind].kind == model::kSurfelKind;
}

/// What a model holds instead of points, for people.
std::string other_kinds(const model::ModelInfo& info) {
  std::string kinds;
  for (const model::KindCount& kind : info.kinds) kinds += (kinds.empty() ? "" : ", ") + kind.kind;
  return kinds.empty() ? "nothing" : "blocks of kind " + kinds;
}

/// Coordinates with the vertical axis last, as corridors are seen.
glm::dvec3 with_height_last(const glm::dvec3& point, bool z_up) {
  return z_up ? point : glm::dvec3(point.z, point.x, point.y);
}

geometry::Box with_height_last(const geometry::Box& box, bool z_up) {
  return {with_height_last(box.min, z_up), with_height_last(box.max, z_up)};
}

/// The elements of a column at some rows.
template <typename T>
std::vector<T> rows_of(const std::vector<T>& column, const std::vector<uint32_t>& rows) {
  std::vector<T> values;
  values.reserve(rows.size());
  for (const uint32_t row : rows) values.push_back(column[row]);
  return values;
}

surfel::ScalarAttribute rows_of(const surfel::ScalarAttribute& attribute, const std::vector<uint32_t>& rows) {
  return {attribute.name,
          std::visit([&rows](const auto& column) { return surfel::ScalarValues(rows_of(column, rows)); },
                     attribute.values)};
}

/// How scans state a system: LAS has codes for those of EPSG, and other authorities only have texts.
std::string crs_text(const model::CoordinateSystem& system) {
  return system.id.starts_with("EPSG:") ? system.id : system.wkt;
}

}  // namespace

ModelPoints::ModelPoints(std::shared_ptr<const model::ModelFile> model, const std::string& name,
                         const ModelSelection& selection)
    : model_(std::move(model)), selection_(selection) {
  schema_.name = name;
  corridors_.corridors = std::exchange(selection_.points.zone.corridors, {});
}

ModelPoints::ModelPoints(ModelPoints&&) noexcept = default;
ModelPoints& ModelPoints::operator=(ModelPoints&&) noexcept = default;
ModelPoints::~ModelPoints() = default;

Result<ModelPoints> ModelPoints::open(std::shared_ptr<const model::ModelFile> model, const std::string& name,
                                      const ModelSelection& selection) {
  ModelPoints points(std::move(model), name, selection);
  Status status = points.describe();
  if (status) status = points.state_system();
  if (!status) return fail(status);
  return points;
}

tl::unexpected<Error> ModelPoints::failed(ErrorKind kind, const std::string& what) const {
  return fail(kind, schema_.name + ": " + what);
}

/// The leaves, and what all points have. The types of attributes are those of any leaf.
Status ModelPoints::describe() {
  const model::ModelInfo& info = model_->info();
  std::optional<uint32_t> sample;
  uint64_t next = 0;
  for (uint32_t i = 0; i < model_->blocks().size(); ++i) {
    const ldc::BlockEntry& entry = model_->blocks()[i];
    if (model_->tree().children(i).count != 0) continue;
    const uint64_t first = next;
    next += entry.items;
    if (!has_points(*model_, entry)) continue;
    if (may_hold(entry.bounds)) leaves_.push_back({i, first});
    sample = i;
  }
  if (!sample) {
    return failed(ErrorKind::kUnsupported, "has no points, but " + other_kinds(info));
  }
  const Result<model::DecodedBlock> block = model_->decode(leaves_.empty() ? *sample : leaves_.front().block);
  if (!block) return fail(block);
  schema_.normals = selection_.normals;
  schema_.color_bits = info.color_bits;
  schema_.z_up = info.z_up;
  for (const surfel::ScalarAttribute& scalar : block->scalars) {
    schema_.scalars.push_back({scalar.name, scan::type_of(scalar.values)});
  }
  const bool classified = std::ranges::count(info.scalar_names, kClassName) > 0;
  if (selection_.points.classes.empty() || classified) return {};
  return failed(ErrorKind::kInvalidInput, "has no classification to choose points by");
}

Status ModelPoints::state_system() {
  const Result<model::Georeference> georeference = model_->georeference();
  if (!georeference) return fail(georeference);
  schema_.crs = crs_text(georeference->system);
  if (!selection_.source_coordinates || !georeference->source.known()) return {};
  Result<std::unique_ptr<const crs::Transformation>> way = way_to_source(*georeference, model_->info().bounds);
  if (!way) return failed(way.error().kind, way.error().message);
  to_source_ = std::move(*way);
  schema_.crs = crs_text(georeference->source);
  return {};
}

bool ModelPoints::may_hold(const geometry::Box& bounds) const {
  return geometry::may_meet(selection_.points.zone, bounds) &&
         geometry::may_meet(corridors_, with_height_last(bounds, model_->info().z_up));
}

bool ModelPoints::holds(const glm::dvec3& point) const {
  return geometry::contains(selection_.points.zone, point) &&
         geometry::contains(corridors_, with_height_last(point, model_->info().z_up));
}

std::vector<bool> ModelPoints::wanted_classes() const {
  std::vector<bool> wanted(256, selection_.points.classes.empty());
  for (const uint8_t code : selection_.points.classes) wanted[code] = true;
  return wanted;
}

uint64_t ModelPoints::step() const {
  return std::clamp<uint64_t>(selection_.points.every, 1, uint64_t{1} << 62);
}

uint64_t ModelPoints::first_row(uint64_t first) const {
  return (step() - first % step()) % step();
}

std::vector<uint32_t> ModelPoints::chosen(const model::DecodedBlock& block, uint64_t first) const {
  std::vector<uint32_t> rows;
  for (uint64_t i = first_row(first); i < block.size(); i += step()) {
    if (holds(block.position(i))) rows.push_back(static_cast<uint32_t>(i));
  }
  if (selection_.points.classes.empty()) return rows;
  const std::vector<bool> wanted = wanted_classes();
  const auto attribute = std::ranges::find(block.scalars, kClassName, &surfel::ScalarAttribute::name);
  std::visit(
      [&](const auto& codes) {
        std::erase_if(rows, [&](uint32_t row) {
          const auto code = static_cast<double>(codes[row]);
          return !(code >= 0 && code < 256 && wanted[static_cast<size_t>(code)]);
        });
      },
      attribute->values);
  return rows;
}

Result<std::vector<glm::dvec3>> ModelPoints::positions(const model::DecodedBlock& block,
                                                       const std::vector<uint32_t>& rows) const {
  std::vector<glm::dvec3> places;
  places.reserve(rows.size());
  for (const uint32_t row : rows) places.push_back(block.position(row));
  if (!to_source_) return places;
  to_source_->apply(places);
  const auto lost = [](const glm::dvec3& p) { return !std::isfinite(p.x + p.y + p.z); };
  if (std::ranges::none_of(places, lost)) return places;
  return failed(ErrorKind::kInvalidInput, "has points without coordinates in the system of the source");
}

/// Without reading them.
bool ModelPoints::takes_all_of(const geometry::Box& bounds) const {
  const std::vector<geometry::Box>& boxes = selection_.points.zone.boxes;
  const auto holds_all = [&bounds](const geometry::Box& box) {
    return geometry::contains(box, bounds.min) && geometry::contains(box, bounds.max);
  };
  return selection_.points.classes.empty() && corridors_.everywhere() &&
         (boxes.empty() || std::ranges::any_of(boxes, holds_all));
}

Result<PointFacts> ModelPoints::count(size_t piece, WantedFacts wanted) const {
  const ldc::BlockEntry& entry = model_->blocks()[leaves_[piece].block];
  if (wanted == WantedFacts::kNumber && takes_all_of(entry.bounds) && !model_->info().in_place) {
    PointFacts facts;
    const uint64_t first = first_row(leaves_[piece].first);
    if (first < entry.items) facts.count = 1 + (entry.items - 1 - first) / step();
    return facts;
  }
  const auto returns = std::ranges::find(schema_.scalars, scan::ScalarField{"return_number", scan::ScalarType::kUint8});
  const bool counted = wanted == WantedFacts::kAll && returns != schema_.scalars.end();
  const bool plain = !counted && selection_.points.classes.empty();
  const Leaf& leaf = leaves_[piece];
  const Result<model::DecodedBlock> block =
      model_->decode(leaf.block, plain ? model::WantedScalars::kNone : model::WantedScalars::kAll);
  if (!block) return fail(block);
  const std::vector<uint32_t> rows = chosen(*block, leaf.first);
  const Result<std::vector<glm::dvec3>> places = positions(*block, rows);
  if (!places) return fail(places);
  PointFacts facts;
  facts.count = rows.size();
  if (!to_source_) facts.grid = block->grid;
  for (const glm::dvec3& place : *places) facts.bounds.include(place);
  if (!counted) return facts;
  const auto& numbers =
      std::get<std::vector<uint8_t>>(block->scalars[static_cast<size_t>(returns - schema_.scalars.begin())].values);
  for (const uint32_t row : rows) {
    const size_t number = numbers[row];
    if (number >= 1 && number <= facts.returns.size()) ++facts.returns[number - 1];
  }
  return facts;
}

Result<scan::ScanPoints> ModelPoints::read(size_t piece) const {
  const Leaf& leaf = leaves_[piece];
  const Result<model::DecodedBlock> block = model_->decode(leaf.block);
  if (!block) return fail(block);
  const std::vector<uint32_t> rows = chosen(*block, leaf.first);
  Result<std::vector<glm::dvec3>> places = positions(*block, rows);
  if (!places) return fail(places);
  scan::ScanPoints points;
  points.positions = std::move(*places);
  if (schema_.normals) points.normals = rows_of(block->normals, rows);
  if (schema_.color_bits != 0) points.colors = surfel::ColorAttribute{schema_.color_bits, rows_of(block->colors, rows)};
  for (const surfel::ScalarAttribute& scalar : block->scalars) points.scalars.push_back(rows_of(scalar, rows));
  return points;
}

}  // namespace surfcast::exporter
