#include <algorithm>
#include <vector>

#include "ellipsoid/ellipsoid_input.h"
#include "fuzz/input_file.h"
#include "fuzz/targets.h"
#include "gaussian/gaussian_reader.h"
#include "grid/grid_reader.h"
#include "grid/open_scan.h"
#include "mesh/mesh_reader.h"
#include "scan/scan_stream.h"

namespace surfcast::fuzz {
namespace {

constexpr scan::DecodingLimit kLimit{size_t{64} << 20};

void read_gaussians(const std::string& path) {
  Result<gaussian::GaussianReader> reader = gaussian::GaussianReader::open(path, kLimit);
  if (!reader) return;
  while (reader->position() < reader->traits().count && reader->read(4096)) {
  }
}

}  // namespace

void read_scan(Bytes bytes) {
  // A copy of its own, so that the sanitizer sees what is read beyond the end.
  const std::vector<std::byte> content(bytes.begin(), bytes.end());
  const Result<scan::ScanStream> stream = scan::ScanStream::open_content(content, "input.xyz", kLimit);
  if (!stream) return;
  for (size_t piece = 0; piece < stream->pieces(); ++piece) {
    if (!stream->read(piece)) return;
  }
}

void read_grid(Bytes bytes) {
  const std::string path = input_file(bytes, "input.grid");
  if (grid::holds_vtk_points(path)) {
    const Result<scan::ScanStream> points = grid::open_scan(path, kLimit);
    for (size_t piece = 0; points && piece < points->pieces() && points->read(piece); ++piece) {
    }
    return;
  }
  Result<grid::GridReader> reader = grid::GridReader::open(path);
  if (!reader) return;
  const size_t sample = reader->header().sample_bytes();
  const uint64_t samples = reader->header().samples();
  std::vector<std::byte> piece;
  while (reader->position() < samples) {
    piece.resize(sample * std::min<uint64_t>(samples - reader->position(), 65536 / sample + 1));
    if (!reader->read(piece)) return;
  }
}

void read_ellipsoid(Bytes bytes) {
  ellipsoid::InputOptions options;
  options.order = grid::TensorOrder::kLower;
  options.asked = true;
  options.limit = kLimit;
  const Result<ellipsoid::InputPtr> input = ellipsoid::open_ellipsoids(input_file(bytes, "input.csv"), options);
  model::EllipsoidCounts counts;
  while (input && !(*input)->at_end() && (*input)->read(counts)) {
  }
}

void read_mesh(Bytes bytes) {
  const std::string path = input_file(bytes, "input.obj");
  const auto format = mesh::mesh_format_of(path, mesh::FacePolicy::kUse);
  if (!format) return;
  static_cast<void>(mesh::files_of_mesh(path, *format));
  static_cast<void>(mesh::read_mesh(path, *format, kLimit));
}

void read_gaussian(Bytes bytes) {
  read_gaussians(input_file(bytes, "input.ply"));
}

void read_splat(Bytes bytes) {
  read_gaussians(input_file(bytes, "input.splat"));
}

}  // namespace surfcast::fuzz
