#include "grid/grid_reader.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <utility>

#include "base/contract.h"
#include "grid/grid_format.h"
#include "grid/readers.h"

namespace surfcast::grid {
namespace {

/// Bytes converted at a time.
constexpr size_t kBuffer = size_t{1} << 16;

Result<StoredGrid> parse(GridFormat format, const GridFile& file) {
  switch (format) {
    case GridFormat::kNrrd:
      return parse_nrrd(file);
    case GridFormat::kMetaImage:
      return parse_meta_image(file);
    case GridFormat::kVtkLegacy:
      return parse_vtk_legacy(file);
    case GridFormat::kVtkXml:
      return parse_vtk_xml(file);
    case GridFormat::kMrtrix:
      return parse_mrtrix(file);
    case GridFormat::kNifti:
      break;
  }
  return parse_nifti(file);
}

void swap_bytes(std::span<std::byte> values, size_t width) {
  for (size_t at = 0; at < values.size(); at += width) std::reverse(&values[at], &values[at] + width);
}

}  // namespace

Status GridReader::named(Status status) const {
  if (status) return status;
  return fail_about(path_.string(), status);
}

Result<GridReader> GridReader::open(const std::filesystem::path& path, std::string_view array,
                                    std::optional<TensorOrder> order) {
  Result<stream::FilePtr> file = stream::open_shared(path);
  if (!file) return fail(file);
  const auto error = [&path](const Error& e) { return fail(e.kind, path.string() + ": " + e.message); };
  if ((*file)->bytes().empty()) return error({ErrorKind::kInvalidInput, "the file is empty"});
  const std::optional<GridFormat> format = grid_format_of(*file);
  if (!format) return error({ErrorKind::kUnsupported, "not a grid of a supported format"});
  Result<StoredGrid> grid = parse(*format, {path, *file, std::string(array), order});
  if (!grid) return error(grid.error());
  return of(path, std::move(*grid));
}

Result<GridReader> GridReader::of(const std::filesystem::path& path, StoredGrid grid) {
  GridReader reader(path, std::move(grid));
  if (Status status = reader.named(reader.restart()); !status) return fail(status);
  return reader;
}

std::vector<std::filesystem::path> GridReader::data_files() const {
  std::vector<std::filesystem::path> files;
  files.reserve(grid_.data_files);
  for (uint64_t i = 0; i < grid_.data_files; ++i) files.push_back(grid_.data_file(i));
  return files;
}

/// Opens the streams at the first sample.
Status GridReader::restart() {
  const GridHeader& header = grid_.header;
  const uint64_t bytes = header.samples() * header.sample_bytes();
  const uint32_t count = grid_.planar ? header.components() : 1;
  streams_.clear();
  position_ = 0;
  for (uint32_t i = 0; i < count; ++i) {
    Result<stream::StreamPtr> stream = grid_.open();
    if (!stream) return fail(stream);
    if ((*stream)->at_most() < bytes) {
      return fail(ErrorKind::kInvalidInput, "truncated: holds at most " + std::to_string((*stream)->at_most()) +
                                                " of " + std::to_string(bytes) + " bytes of samples");
    }
    if (Status status = (*stream)->skip(bytes / count * i); !status) return status;
    streams_.push_back(std::move(*stream));
  }
  return {};
}

/// Brings the components of a sample together, a bufferful of each at a time.
Status GridReader::read_planes(std::span<std::byte> samples) {
  const size_t width = scan::size_of(grid_.header.type);
  const size_t stride = grid_.header.sample_bytes();
  std::array<std::byte, kBuffer> plane;
  for (; !samples.empty(); samples = samples.subspan(std::min(samples.size(), kBuffer / width * stride))) {
    const size_t count = std::min(samples.size() / stride, kBuffer / width);
    for (size_t component = 0; component < streams_.size(); ++component) {
      const std::span values = std::span(plane).first(count * width);
      if (Status status = read_exactly(*streams_[component], values); !status) return status;
      for (size_t i = 0; i < count; ++i) {
        std::memcpy(&samples[i * stride + component * width], &values[i * width], width);
      }
    }
  }
  return {};
}

Status GridReader::read(std::span<std::byte> samples) {
  const GridHeader& header = grid_.header;
  const uint64_t count = samples.size() / header.sample_bytes();
  SURFCAST_EXPECTS(samples.size() % header.sample_bytes() == 0 && count <= header.samples() - position_);
  Status status = grid_.planar ? read_planes(samples) : read_exactly(*streams_.front(), samples);
  if (!status) return named(std::move(status));
  if (grid_.swapped) swap_bytes(samples, scan::size_of(header.type));
  position_ += count;
  return position_ == header.samples() ? named(finish()) : Status();
}

Status GridReader::read(std::span<double> values) {
  const size_t width = scan::size_of(grid_.header.type);
  const size_t most = kBuffer / grid_.header.sample_bytes() * grid_.header.components();
  std::array<std::byte, kBuffer> buffer;
  while (!values.empty()) {
    const std::span part = values.first(std::min(values.size(), most));
    const std::span bytes = std::span(buffer).first(part.size() * width);
    if (Status status = read(bytes); !status) return status;
    scan::with_type(grid_.header.type, [&](auto zero) {
      for (size_t i = 0; i < part.size(); ++i) {
        part[i] = static_cast<double>(scan::load<decltype(zero)>(&bytes[i * width]));
      }
    });
    values = values.subspan(part.size());
  }
  return {};
}

Status GridReader::seek(uint64_t sample) {
  SURFCAST_EXPECTS(sample <= grid_.header.samples());
  if (sample < position_) {
    if (Status status = restart(); !status) return named(std::move(status));
  }
  const uint64_t bytes = (sample - position_) * (grid_.header.sample_bytes() / streams_.size());
  for (const stream::StreamPtr& stream : streams_) {
    if (Status status = stream->skip(bytes); !status) return named(std::move(status));
  }
  position_ = sample;
  return {};
}

/// Decoders compare their checksums behind the last sample.
Status GridReader::finish() {
  for (const stream::StreamPtr& stream : streams_) {
    if (Status status = check_end(*stream); !status) return status;
  }
  return {};
}

}  // namespace surfcast::grid
