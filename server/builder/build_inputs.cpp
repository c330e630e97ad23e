#include "builder/build_inputs.h"

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

#include "grid/open_scan.h"
#include "scan/clean_points.h"
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

Result<BuildInputs> BuildInputs::open(std::span<const std::filesystem::path> paths, const OpenInput& open,
                                      std::optional<bool> z_up, uint64_t max_bytes, std::optional<uint64_t> sample,
                                      const std::function<void(double)>& progress) {
  BuildInputs inputs;
  for (const std::filesystem::path& path : paths) {
    progress(static_cast<double>(inputs.streams_.size()) / static_cast<double>(paths.size()));
    const scan::DecodingLimit limit{max_bytes - inputs.held_bytes()};
    Result<scan::ScanStream> stream = open ? open(path, limit, sample) : grid::open_scan(path, limit, sample);
    if (!stream) return fail(std::move(stream.error()));
    for (size_t piece = 0; piece < stream->pieces(); ++piece) {
      inputs.pieces_.push_back({inputs.streams_.size(), piece});
    }
    inputs.schemas_.push_back(stream->schema());
    inputs.bounds_.push_back(stream->bounds());
    inputs.streams_.push_back(std::move(*stream));
  }
  inputs.moves_.resize(inputs.streams_.size());
  inputs.z_up_ = z_up;
  inputs.merge();
  return inputs;
}

void BuildInputs::merge() {
  schema_ = scan::merge_schemas(schemas_);
  schema_.z_up = z_up_.value_or(schema_.z_up);
}

Result<Placement> BuildInputs::place(const SystemOptions& options) {
  Result<Placement> placement = place_inputs(schemas_, bounds_, options);
  if (!placement) return placement;
  for (size_t input = 0; input < streams_.size(); ++input) {
    if (!placement->moves[input]) continue;
    moves_[input] = placement->moves[input];
    if (Status status = move(input, *moves_[input]); !status) return fail(std::move(status.error()));
  }
  merge();
  return placement;
}

/// Reads all points of the input, because a box around them is no box in another system.
Status BuildInputs::move(size_t input, const crs::Transformation& transformation) {
  const scan::ScanStream& stream = streams_[input];
  std::vector<Result<geometry::Box>> boxes(stream.pieces());
  oneapi::tbb::parallel_for(size_t{0}, stream.pieces(), [&](size_t piece) {
    Result<scan::ScanPoints> points = stream.read(piece);
    if (!points) {
      boxes[piece] = fail(std::move(points.error()));
      return;
    }
    transformation.apply(points->positions);
    geometry::Box box;
    for (const glm::dvec3& p : points->positions) {
      if (is_finite(p)) box.include(p);
    }
    boxes[piece] = box;
  });
  bounds_[input] = {};
  for (const Result<geometry::Box>& box : boxes) {
    if (!box) return fail(box.error());
    bounds_[input].include(*box);
  }
  move_schema(transformation, schemas_[input]);
  return {};
}

uint64_t BuildInputs::size() const {
  uint64_t size = 0;
  for (const scan::ScanStream& stream : streams_) size += stream.size();
  return size;
}

uint64_t BuildInputs::size_of_files() const {
  uint64_t size = 0;
  for (const scan::ScanStream& stream : streams_) size += stream.size_of_file();
  return size;
}

uint64_t BuildInputs::held_bytes() const {
  uint64_t bytes = 0;
  for (const scan::ScanStream& stream : streams_) bytes += stream.held_bytes();
  return bytes;
}

geometry::Box BuildInputs::bounds() const {
  geometry::Box box;
  for (const geometry::Box& bounds : bounds_) box.include(bounds);
  return box;
}

std::vector<std::string> BuildInputs::notes() const {
  return scan::describe_fillings(schemas_, schema_);
}

Result<InputPiece> BuildInputs::read(size_t piece, scan::SurfelReport& report) const {
  const auto& [source, number] = pieces_[piece];
  Result<scan::ScanPoints> points = streams_[source].read(number);
  if (!points) return fail(std::move(points.error()));
  if (moves_[source]) move_points(*moves_[source], *points);
  report.points_read += points->size();
  scan::drop_unusable_points(*points, report);
  return InputPiece{source, scan::conform(std::move(*points), schema_)};
}

}  // namespace surfcast::builder
