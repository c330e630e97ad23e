#include "builder/build_inputs.h"

#include <utility>

#include "scan/clean_points.h"
#include "scan/merge_schemas.h"

namespace surfcast::builder {
namespace {

std::vector<scan::ScanSchema> schemas_of(const std::vector<scan::ScanStream>& streams) {
  std::vector<scan::ScanSchema> schemas;
  schemas.reserve(streams.size());
  for (const scan::ScanStream& stream : streams) schemas.push_back(stream.schema());
  return schemas;
}

}  // namespace

Result<BuildInputs> BuildInputs::open(std::span<const std::filesystem::path> paths, const OpenInput& open,
                                      std::optional<bool> z_up, uint64_t max_bytes, std::optional<uint64_t> sample,
                                      const std::function<void(double)>& progress) {
  BuildInputs inputs;
  for (const std::filesystem::path& path : paths) {
    progress(static_cast<double>(inputs.streams_.size()) / static_cast<double>(paths.size()));
    const scan::DecodingLimit limit{max_bytes - inputs.held_bytes()};
    Result<scan::ScanStream> stream = open ? open(path, limit, sample) : scan::ScanStream::open(path, limit, sample);
    if (!stream) return fail(std::move(stream.error()));
    for (size_t piece = 0; piece < stream->pieces(); ++piece) {
      inputs.pieces_.push_back({inputs.streams_.size(), piece});
    }
    inputs.streams_.push_back(std::move(*stream));
  }
  inputs.schema_ = scan::merge_schemas(schemas_of(inputs.streams_));
  inputs.schema_.z_up = z_up.value_or(inputs.schema_.z_up);
  return inputs;
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
  for (const scan::ScanStream& stream : streams_) box.include(stream.bounds());
  return box;
}

std::vector<std::string> BuildInputs::notes() const {
  return scan::describe_fillings(schemas_of(streams_), schema_);
}

Result<InputPiece> BuildInputs::read(size_t piece, scan::SurfelReport& report) const {
  const auto& [source, number] = pieces_[piece];
  Result<scan::ScanPoints> points = streams_[source].read(number);
  if (!points) return fail(std::move(points.error()));
  report.points_read += points->size();
  scan::drop_unusable_points(*points, report);
  return InputPiece{source, scan::conform(std::move(*points), schema_)};
}

}  // namespace surfcast::builder
