#include "builder/build_inputs.h"

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

#include "base/contract.h"
#include "estimation/clean_points.h"
#include "grid/open_scan.h"
#include "scan/merge_schemas.h"

namespace surfcast::builder {
namespace {

/// Points of a scan in another coordinate system.
void move_points(const crs::Transformation& move, scan::ScanPoints& points) {
  move.apply(points.positions);
  const glm::mat3 turn(move.turn());
  for (glm::vec3& normal : points.normals) normal = turn * normal;
  for (float& radius : points.radii) radius *= static_cast<float>(move.length_factor());
}

/// What is known of such a scan before its points are read.
void move_schema(const crs::Transformation& move, scan::ScanSchema& schema) {
  schema.grid.reset();
  schema.z_up = true;
  if (schema.sensor) move.apply({&*schema.sensor, 1});
  if (schema.surface_step) *schema.surface_step *= move.length_factor();
}

bool is_finite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

}  // namespace

void BuildInputs::add(InputFacts facts, std::optional<scan::ScanStream> stream) {
  for (size_t piece = 0; piece < facts.pieces; ++piece) pieces_.push_back({streams_.size(), piece});
  schemas_.push_back(facts.scan.meaning.schema);
  facts_.push_back(std::move(facts));
  streams_.push_back(std::move(stream));
  moves_.emplace_back();
}

Result<BuildInputs> BuildInputs::open(std::span<const std::filesystem::path> paths, const OpenInput& open,
                                      std::optional<bool> z_up, uint64_t max_bytes, std::optional<uint64_t> sample,
                                      const std::function<void(double)>& progress) {
  BuildInputs inputs;
  for (const std::filesystem::path& path : paths) {
    progress(static_cast<double>(inputs.streams_.size()) / static_cast<double>(paths.size()));
    const scan::DecodingLimit limit{max_bytes - inputs.held_bytes()};
    Result<scan::ScanStream> stream = open ? open(path, limit, sample) : grid::open_scan(path, limit, sample);
    if (!stream) return fail(stream);
    InputFacts facts{stream->facts(), stream->bounds(), stream->pieces()};
    inputs.add(std::move(facts), std::move(*stream));
  }
  inputs.z_up_ = z_up;
  inputs.merge();
  return inputs;
}

Result<BuildInputs> BuildInputs::reopen(const Reopening& reopening, std::vector<InputFacts> facts) {
  SURFCAST_EXPECTS(reopening.paths.size() == facts.size() && reopening.read.size() == facts.size());
  BuildInputs inputs;
  for (size_t i = 0; i < facts.size(); ++i) {
    std::optional<scan::ScanStream> stream;
    if (reopening.read[i]) {
      const scan::DecodingLimit limit{reopening.max_bytes - inputs.held_bytes()};
      Result<scan::ScanStream> opened =
          grid::reopen_scan(reopening.paths[i], limit, reopening.selection, facts[i].scan);
      if (!opened) return fail(opened);
      if (opened->pieces() != facts[i].pieces) {
        return fail(ErrorKind::kInvalidInput, reopening.paths[i].string() + ": has changed since it was first read");
      }
      stream = std::move(*opened);
    }
    inputs.add(std::move(facts[i]), std::move(stream));
  }
  inputs.z_up_ = reopening.z_up;
  Result<Placement> placement = inputs.find_place(reopening.systems);
  if (!placement) return fail(placement);
  return inputs;
}

void BuildInputs::merge() {
  schema_ = scan::merge_schemas(schemas_);
  schema_.z_up = z_up_.value_or(schema_.z_up);
}

/// Finds out how all inputs come into one system, and what their schemas are there.
Result<Placement> BuildInputs::find_place(const SystemOptions& options) {
  std::vector<geometry::Box> bounds;
  for (const InputFacts& input : facts_) bounds.push_back(input.scan.bounds);
  Result<Placement> placement = place_inputs(schemas_, bounds, options);
  if (!placement) return placement;
  moves_ = placement->moves;
  georeference_ = placement->georeference;
  for (size_t input = 0; input < moves_.size(); ++input) {
    if (moves_[input]) move_schema(*moves_[input], schemas_[input]);
  }
  merge();
  return placement;
}

Result<Placement> BuildInputs::place(const SystemOptions& options) {
  Result<Placement> placement = find_place(options);
  if (!placement) return placement;
  for (size_t input = 0; input < streams_.size(); ++input) {
    if (!moves_[input]) continue;
    if (Status status = measure(input); !status) return fail(status);
  }
  return placement;
}

/// Reads all points of an input that is moved, because a box around them is no box in another system.
Status BuildInputs::measure(size_t input) {
  const scan::ScanStream& stream = *streams_[input];
  std::vector<Result<geometry::Box>> boxes(stream.pieces());
  oneapi::tbb::parallel_for(size_t{0}, stream.pieces(), [&](size_t piece) {
    Result<scan::ScanPoints> points = stream.read(piece);
    if (!points) {
      boxes[piece] = fail(points);
      return;
    }
    moves_[input]->apply(points->positions);
    geometry::Box box;
    for (const glm::dvec3& p : points->positions) {
      if (is_finite(p)) box.include(p);
    }
    boxes[piece] = box;
  });
  geometry::Box& bounds = facts_[input].bounds;
  bounds = {};
  for (const Result<geometry::Box>& box : boxes) {
    if (!box) return fail(box);
    bounds.include(*box);
  }
  return {};
}

uint64_t BuildInputs::size() const {
  uint64_t size = 0;
  for (const InputFacts& input : facts_) size += input.scan.points;
  return size;
}

uint64_t BuildInputs::size_of_files() const {
  uint64_t size = 0;
  for (const InputFacts& input : facts_) size += input.scan.points_of_file;
  return size;
}

uint64_t BuildInputs::held_bytes() const {
  uint64_t bytes = 0;
  for (const std::optional<scan::ScanStream>& stream : streams_) bytes += stream ? stream->held_bytes() : 0;
  return bytes;
}

geometry::Box BuildInputs::bounds() const {
  geometry::Box box;
  for (const InputFacts& input : facts_) box.include(input.bounds);
  return box;
}

std::vector<std::string> BuildInputs::notes() const {
  return scan::describe_fillings(schemas_, schema_);
}

Result<InputPiece> BuildInputs::read(size_t piece, estimation::SurfelReport& report) const {
  const auto& [source, number] = pieces_[piece];
  SURFCAST_EXPECTS(streams_[source].has_value());
  Result<scan::ScanPoints> points = streams_[source]->read(number);
  if (!points) return fail(points);
  if (moves_[source]) move_points(*moves_[source], *points);
  report.points_read += points->size();
  estimation::drop_unusable_points(*points, report);
  return InputPiece{source, scan::conform(std::move(*points), schema_)};
}

}  // namespace surfcast::builder
