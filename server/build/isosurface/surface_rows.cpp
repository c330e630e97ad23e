#include "isosurface/surface_rows.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <spdlog/fmt/fmt.h>

#include "base/spool_file.h"
#include "grid/grid_reader.h"
#include "isosurface/plane_points.h"
#include "isosurface/point_records.h"
#include "isosurface/sample_window.h"

namespace surfcast::isosurface {
namespace {

/// Planes that are worked on together: enough rows for all threads.
constexpr int64_t kMaxPlanes = 32;
/// Memory for planes that is used even if there is more.
constexpr uint64_t kUsefulMemory = uint64_t{64} << 20;

/// The lowest and the highest sample that are numbers.
struct ValueRange {
  double low = INFINITY;
  double high = -INFINITY;

  void include(double value) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
};

std::string describe(const ValueRange& range) {
  if (range.low > range.high) return "no sample is a number";
  if (range.low == range.high) return fmt::format("all samples are {}", range.low);
  return fmt::format("the samples are from {} to {}", range.low, range.high);
}

Status check_scalar(const grid::GridHeader& header) {
  if (header.kind == grid::SampleKind::kScalar) return {};
  return fail(ErrorKind::kUnsupported, "the samples are tensors, which have no surface of one value");
}

/// How many planes are worked on together, beside those that their points depend on.
Result<int64_t> planes_together(const grid::GridHeader& header, uint64_t memory) {
  const uint64_t plane = header.size[0] * header.size[1] * sizeof(double);
  const auto fitting = [plane](uint64_t bytes) {
    return static_cast<int64_t>(bytes / plane) - (kPlanesBefore + kPlanesBehind);
  };
  const int64_t most = fitting(memory);
  if (most < 1) {
    return fail(ErrorKind::kLimit, fmt::format("a plane of its samples takes {} bytes of memory; {} are left for {}",
                                               plane, memory, kPlanesBefore + kPlanesBehind + 1));
  }
  return std::clamp<int64_t>(fitting(kUsefulMemory), 1, std::min(most, kMaxPlanes));
}

/// The moved samples of successive planes for one surface.
struct SurfacePlanes {
  IsoSurface surface;
  SurfaceReport report{};
  std::vector<PlanePoints> planes{};
};

/// The points of a plane that are needed.
struct PackedPlane {
  std::vector<std::byte> records;
  uint64_t thinned = 0;
  uint64_t lost = 0;
};

/// Finds the points of all surfaces in one pass over the planes of a grid.
class SurfacePass {
 public:
  SurfacePass(grid::GridReader& reader, std::span<const IsoSurface> surfaces, int64_t together, SpoolFile& file)
      : reader_(reader),
        size_(Index(reader.header().size[0], reader.header().size[1], reader.header().size[2])),
        together_(together),
        records_(reader.header().index_to_world, surfaces),
        samples_(size_),
        file_(file) {
    for (const IsoSurface& surface : surfaces) surfaces_.push_back({surface, {surface.value}});
  }

  Status run() {
    for (int64_t first = 0; first < size_.z; first += together_) {
      const int64_t end = std::min(first + together_, size_.z);
      if (Status status = read_to(std::min(end + kPlanesBehind, size_.z)); !status) return status;
      samples_.drop_before(first - kPlanesBefore);
      find_points(first, end);
      if (Status status = write_to(end == size_.z ? end : end - kThinningReach); !status) return status;
    }
    return {};
  }

  [[nodiscard]] const PointRecords& records() const { return records_; }
  [[nodiscard]] const ValueRange& range() const { return range_; }
  [[nodiscard]] std::vector<SurfaceReport> reports() const {
    std::vector<SurfaceReport> reports;
    for (const SurfacePlanes& surface : surfaces_) reports.push_back(surface.report);
    return reports;
  }

 private:
  Status read_to(int64_t end);
  void find_points(int64_t first, int64_t end);
  Status write_to(int64_t end);
  [[nodiscard]] PackedPlane pack_plane(const SurfacePlanes& surface, int64_t plane) const;
  Status keep(const PackedPlane& plane, SurfaceReport& report);
  void drop_planes_before(int64_t plane);

  grid::GridReader& reader_;
  Index size_;
  int64_t together_;
  PointRecords records_;
  SampleWindow samples_;
  SpoolFile& file_;
  std::vector<SurfacePlanes> surfaces_;
  int64_t first_plane_ = 0;  ///< of SurfacePlanes::planes
  int64_t written_ = 0;      ///< planes
  ValueRange range_;
};

/// Reads planes, in the unit of the samples.
Status SurfacePass::read_to(int64_t end) {
  const grid::GridHeader& header = reader_.header();
  while (samples_.end() < end) {
    const std::span<double> plane = samples_.append();
    if (Status status = reader_.read(plane); !status) return status;
    for (double& value : plane) {
      value = header.slope * value + header.intercept;
      range_.include(value);
    }
  }
  return {};
}

void SurfacePass::find_points(int64_t first, int64_t end) {
  const auto rows = static_cast<size_t>(size_.y);
  for (SurfacePlanes& surface : surfaces_) {
    const size_t known = surface.planes.size();
    surface.planes.resize(known + static_cast<size_t>(end - first), PlanePoints(rows));
    oneapi::tbb::parallel_for(size_t{0}, static_cast<size_t>(end - first) * rows, [&](size_t task) {
      const size_t plane = task / rows;
      const size_t row = task % rows;
      surface.planes[known + plane][row] = points_of_row(samples_, static_cast<int64_t>(row),
                                                         first + static_cast<int64_t>(plane), surface.surface.value);
    });
  }
}

PackedPlane SurfacePass::pack_plane(const SurfacePlanes& surface, int64_t plane) const {
  const auto own = static_cast<size_t>(plane - first_plane_);
  const size_t first = own - std::min<size_t>(own, kThinningReach);
  const size_t end = std::min(own + kThinningReach + 1, surface.planes.size());
  const std::span around = std::span(surface.planes).subspan(first, end - first);
  const PlanePoints& rows = surface.planes[own];
  PackedPlane packed;
  for (size_t j = 0; j < rows.size(); ++j) {
    packed.lost += rows[j].lost;
    for (const MovedSample& moved : rows[j].points) {
      if (is_needed(moved, static_cast<int64_t>(j), around)) {
        records_.append(moved.point, surface.surface, packed.records);
      } else {
        ++packed.thinned;
      }
    }
  }
  return packed;
}

/// Writes the points of the planes before `end`, whose neighbours are known: plane by plane, so that their order does
/// not depend on how many planes are in memory.
Status SurfacePass::write_to(int64_t end) {
  const size_t count = surfaces_.size();
  std::vector<PackedPlane> packed(static_cast<size_t>(std::max<int64_t>(end - written_, 0)) * count);
  oneapi::tbb::parallel_for(size_t{0}, packed.size(), [&](size_t task) {
    packed[task] = pack_plane(surfaces_[task % count], written_ + static_cast<int64_t>(task / count));
  });
  for (size_t task = 0; task < packed.size(); ++task) {
    if (Status status = keep(packed[task], surfaces_[task % count].report); !status) return status;
  }
  written_ = std::max(written_, end);
  drop_planes_before(written_ - kThinningReach);
  return {};
}

Status SurfacePass::keep(const PackedPlane& plane, SurfaceReport& report) {
  const Result<uint64_t> place = file_.append(plane.records);
  if (!place) return fail(place);
  report.points += plane.records.size() / records_.size();
  report.thinned += plane.thinned;
  report.lost += plane.lost;
  return {};
}

void SurfacePass::drop_planes_before(int64_t plane) {
  const int64_t first = std::max(plane, first_plane_);
  for (SurfacePlanes& surface : surfaces_) {
    surface.planes.erase(surface.planes.begin(), surface.planes.begin() + (first - first_plane_));
  }
  first_plane_ = first;
}

Status check_found(const SurfacePass& pass) {
  for (const SurfaceReport& report : pass.reports()) {
    if (report.points > 0) continue;
    return fail(ErrorKind::kInvalidInput,
                fmt::format("no surface at {}: {}", report.value,
                            report.lost > 0 ? "samples on both sides of it have neighbours that are not numbers"
                                            : describe(pass.range())));
  }
  return {};
}

}  // namespace

Result<SurfaceRows> find_surfaces(const std::filesystem::path& grid, std::span<const IsoSurface> surfaces,
                                  uint64_t memory, const std::filesystem::path& target) {
  const auto named = [&grid](const Error& error) { return fail(error.kind, grid.string() + ": " + error.message); };
  Result<grid::GridReader> reader = grid::GridReader::open(grid);
  if (!reader) return fail(reader);
  if (Status status = check_scalar(reader->header()); !status) return named(status.error());
  const Result<int64_t> together = planes_together(reader->header(), memory);
  if (!together) return named(together.error());
  Result<SpoolFile> file = SpoolFile::create(target);
  if (!file) return fail(file);
  SurfacePass pass(*reader, surfaces, *together, *file);
  if (Status status = pass.run(); !status) return fail(status);
  if (Status status = check_found(pass); !status) return named(status.error());
  return SurfaceRows{rows_of(std::move(*file), pass.records()), pass.reports()};
}

}  // namespace surfcast::isosurface
