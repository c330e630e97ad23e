#include "builder/grid_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "grid/grid_format.h"
#include "grid/vtk_points.h"

namespace surfcast::builder {
namespace {

/// Samples read at a time.
constexpr size_t kPart = size_t{1} << 14;

/// Samples along an axis, if one of so many is taken.
uint64_t taken_of(uint64_t samples, uint64_t stride) {
  return (samples + stride - 1) / stride;
}

/// The smallest stride that leaves at most so many samples. Beyond the longest axis one is left.
uint64_t stride_for(const grid::GridHeader& header, uint64_t most) {
  const auto left = [&](uint64_t stride) {
    return taken_of(header.size[0], stride) * taken_of(header.size[1], stride) * taken_of(header.size[2], stride);
  };
  uint64_t stride = 1;
  while (left(stride) > std::max<uint64_t>(most, 1)) ++stride;
  return stride;
}

model::Volume volume_of(const grid::GridHeader& header, const std::filesystem::path& path, uint64_t stride) {
  model::Volume volume;
  volume.name = header.name.empty() ? path.stem().string() : header.name;
  volume.index_to_world = header.index_to_world;
  for (int axis = 0; axis < 3; ++axis) {
    volume.size[axis] = static_cast<uint32_t>(taken_of(header.size[axis], stride));
    volume.index_to_world[axis] *= static_cast<double>(stride);
  }
  volume.frame = static_cast<model::WorldFrame>(header.frame);  // the same enumerators
  volume.length_unit = header.length_unit;
  volume.sample_unit = header.sample_unit;
  volume.type = static_cast<uint8_t>(header.type);
  volume.slope = header.slope;
  volume.intercept = header.intercept;
  volume.histogram.assign(model::kHistogramBins, 0);
  return volume;
}

}  // namespace

static_assert(static_cast<int>(grid::WorldFrame::kLps) == static_cast<int>(model::WorldFrame::kLps));

bool is_grid(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  const Result<stream::FilePtr> file = stream::open_shared(path);
  if (!file || (*file)->bytes().empty() || grid::is_vtk_point_set(*file)) return false;
  return grid::grid_format_of(*file).has_value();
}

GridInput::GridInput(std::filesystem::path path, grid::GridReader reader, uint64_t stride)
    : path_(std::move(path)),
      reader_(std::move(reader)),
      stride_(stride),
      volume_(volume_of(reader_.header(), path_, stride)) {}

Status GridInput::failed(ErrorKind kind, const std::string& what) const {
  return fail(kind, path_.string() + ": " + what);
}

Result<GridInput> GridInput::open(const std::filesystem::path& path, std::optional<uint64_t> sample) {
  Result<grid::GridReader> reader = grid::GridReader::open(path);
  if (!reader) return fail(reader);
  return of(path, std::move(*reader), sample);
}

Result<GridInput> GridInput::of(const std::filesystem::path& path, grid::GridReader reader,
                                std::optional<uint64_t> sample) {
  const grid::GridHeader& header = reader.header();
  if (header.components() > 1) {
    return fail(ErrorKind::kUnsupported, path.string() + ": holds tensors of " + std::to_string(header.components()) +
                                             " components; volumes are made of grids with one number a sample");
  }
  const uint64_t longest = std::ranges::max(header.size);
  if (longest > model::kMaxAxisSamples) {
    return fail(ErrorKind::kLimit, path.string() + ": has " + std::to_string(longest) +
                                       " samples along an axis; a volume has at most " +
                                       std::to_string(model::kMaxAxisSamples));
  }
  const uint64_t stride = sample ? stride_for(header, *sample) : 1;
  return GridInput(path, std::move(reader), stride);
}

bool GridInput::needs_doubles() const {
  return header().type != scan::ScalarType::kFloat32 && scan::size_of(header().type) > 2;
}

Status GridInput::rewind() {
  column_ = row_.size();
  next_row_ = 0;
  return reader_.seek(0);
}

/// Reads the row that the volume has next, and keeps every few of its samples.
Status GridInput::read_row() {
  const auto& [width, height, depth] = header().size;
  const uint64_t j = next_row_ % volume_.size.y;
  const uint64_t k = next_row_ / volume_.size.y;
  if (Status status = reader_.seek((k * height + j) * stride_ * width); !status) return status;
  row_.resize(width);
  if (Status status = reader_.read(row_); !status) return status;
  for (size_t i = 0; i < volume_.size.x; ++i) row_[i] = row_[i * stride_];
  row_.resize(volume_.size.x);
  column_ = 0;
  ++next_row_;
  return {};
}

/// The next samples of the volume.
Status GridInput::read_next(std::span<double> samples) {
  if (stride_ == 1) return reader_.read(samples);
  for (double& sample : samples) {
    if (column_ == row_.size()) {
      if (Status status = read_row(); !status) return status;
    }
    sample = row_[column_++];
  }
  return {};
}

Status GridInput::measure(const std::function<void()>& plane_done) {
  low_ = std::numeric_limits<double>::infinity();
  high_ = -low_;
  std::array<double, kPart> buffer{};
  const uint64_t plane = uint64_t{volume_.size.x} * volume_.size.y;
  for (uint64_t left = volume_.samples(); left > 0;) {
    // Parts end where planes end.
    const uint64_t of_plane = (left - 1) % plane + 1;
    const std::span part = std::span(buffer).first(std::min<uint64_t>(of_plane, kPart));
    if (Status status = read_next(part); !status) return status;
    for (const double sample : part) {
      if (!std::isfinite(sample)) {
        ++not_finite_;
        continue;
      }
      low_ = std::min(low_, sample);
      high_ = std::max(high_, sample);
      integral_ = integral_ && sample == std::floor(sample);
    }
    left -= part.size();
    if (left % plane == 0) plane_done();
  }
  if (not_finite_ == volume_.samples()) return failed(ErrorKind::kInvalidInput, "no sample of the grid is finite");
  const auto [low, high] =
      std::minmax({header().slope * low_ + header().intercept, header().slope * high_ + header().intercept});
  if (!(std::max(-low, high) <= double{std::numeric_limits<float>::max()})) {
    return failed(ErrorKind::kLimit, "has values beyond 3.4e38, the largest number of single precision");
  }
  volume_.low = low;
  volume_.high = high;
  return rewind();
}

void GridInput::count(std::span<const double> samples) {
  const double first = header().slope > 0 ? low_ : high_;
  const double bins = high_ > low_ ? static_cast<double>(model::kHistogramBins) / (high_ - low_) : 0;
  constexpr double kLast = static_cast<double>(model::kHistogramBins - 1);
  for (const double sample : samples) {
    ++volume_.histogram[static_cast<size_t>(std::min(std::abs(sample - first) * bins, kLast))];
  }
}

Status GridInput::read_part(std::span<double> samples) {
  if (Status status = read_next(samples); !status) return status;
  const double lowest = header().slope > 0 ? low_ : high_;
  if (not_finite_ > 0) {
    std::ranges::replace_if(
        samples, [](double sample) { return !std::isfinite(sample); }, lowest);
  }
  count(samples);
  return {};
}

template <typename Sample>
Status GridInput::read_plane(std::span<Sample> samples) {
  std::array<double, kPart> buffer{};
  while (!samples.empty()) {
    const std::span part = std::span(buffer).first(std::min(samples.size(), kPart));
    if (Status status = read_part(part); !status) return status;
    std::ranges::transform(part, samples.begin(), [](double sample) { return static_cast<Sample>(sample); });
    samples = samples.subspan(part.size());
  }
  return {};
}

template Status GridInput::read_plane(std::span<float> samples);
template Status GridInput::read_plane(std::span<double> samples);

}  // namespace surfcast::builder
