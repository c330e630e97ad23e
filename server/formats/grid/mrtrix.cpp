#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

#include "base/ascii_text.h"
#include "grid/header_text.h"
#include "grid/readers.h"
#include "scan/text_tokens.h"
#include "stream/inflate_stream.h"

namespace surfcast::grid {
namespace {

using stream::FilePtr;
using stream::StreamPtr;

constexpr std::string_view kMrtrix = "MRtrix";
constexpr std::string_view kMagic = "mrtrix image";
constexpr size_t kMaxHeader = size_t{1} << 20;
constexpr uint64_t kTensorImages = 6;

/// The first bytes of a file, unpacked; fewer if it is shorter.
std::string head_of(const FilePtr& file, size_t size) {
  const StreamPtr stream = stream::open_inflated(file);
  std::vector<std::byte> head(size);
  const Result<size_t> got = stream->read(head);
  return std::string(scan::as_text(std::span(head).first(got.value_or(0))));
}

/// Values of the keys, which may occur several times.
using KeyLines = std::map<std::string, std::vector<std::string>, std::less<>>;

Result<KeyLines> split_mrtrix_header(std::string_view text) {
  HeaderLines lines(text);
  lines.next();
  KeyLines keys;
  while (const std::optional<std::string_view> line = lines.next()) {
    if (trimmed(*line) == "END") return keys;
    const size_t colon = line->find(':');
    if (colon == std::string_view::npos) return bad_header(kMrtrix, "line not understood", *line);
    keys[to_lower(trimmed(line->substr(0, colon)))].emplace_back(trimmed(line->substr(colon + 1)));
  }
  return fail(ErrorKind::kInvalidInput, "truncated: MRtrix header without END");
}

std::string_view value_of(const KeyLines& keys, std::string_view key) {
  const auto found = keys.find(key);
  return found == keys.end() ? std::string_view() : std::string_view(found->second.front());
}

std::string with_spaces(std::string_view text) {
  std::string spaced(text);
  std::replace(spaced.begin(), spaced.end(), ',', ' ');
  return spaced;
}

/// An axis in the order of storage: 0 is the fastest.
struct StoredAxis {
  int64_t rank = 0;
  bool backward = false;
};

Result<std::vector<StoredAxis>> parse_layout(std::string_view text, size_t axes) {
  std::vector<StoredAxis> layout;
  const std::string spaced = with_spaces(text);  // the words are parts of it
  for (const std::string_view word : words_of(spaced)) {
    const auto rank = scan::parse_number<int64_t>(word.substr(word.starts_with('-') ? 1 : 0));
    if (!rank || *rank < 0 || *rank >= static_cast<int64_t>(axes)) return bad_header(kMrtrix, "wrong layout", text);
    layout.push_back({*rank, word.starts_with('-')});
  }
  std::vector<bool> seen(axes);
  for (const StoredAxis& axis : layout) seen[static_cast<size_t>(axis.rank)] = true;
  const bool all = std::all_of(seen.begin(), seen.end(), [](bool b) { return b; });
  if (layout.size() != axes || !all) return bad_header(kMrtrix, "wrong layout", text);
  return layout;
}

struct SampleType {
  ScalarType type = ScalarType::kFloat32;
  bool swapped = false;
};

Result<SampleType> parse_mrtrix_type(std::string_view text) {
  static constexpr std::pair<std::string_view, ScalarType> kTypes[] = {
      {"int8", ScalarType::kInt8},       {"uint8", ScalarType::kUint8},   {"int16", ScalarType::kInt16},
      {"uint16", ScalarType::kUint16},   {"int32", ScalarType::kInt32},   {"uint32", ScalarType::kUint32},
      {"int64", ScalarType::kInt64},     {"uint64", ScalarType::kUint64}, {"float32", ScalarType::kFloat32},
      {"float64", ScalarType::kFloat64},
  };
  const std::string word = to_lower(text);
  const bool big = word.ends_with("be");
  const bool ordered = big || word.ends_with("le");
  const std::string_view plain = std::string_view(word).substr(0, word.size() - (ordered ? 2 : 0));
  for (const auto& [name, type] : kTypes) {
    if (name == plain) return SampleType{type, ordered && big == (std::endian::native == std::endian::little)};
  }
  return fail(ErrorKind::kUnsupported, "MRtrix: type of samples not supported: " + scan::printable(text));
}

/// The columns are the axes of the image in the world, then the place of its first sample.
Result<glm::dmat4x3> parse_transform(const KeyLines& keys) {
  glm::dmat4x3 transform(1.0);
  const auto found = keys.find("transform");
  if (found == keys.end()) return transform;
  std::vector<double> numbers;
  for (const std::string& row : found->second) {
    const auto parsed = numbers_of(with_spaces(row));
    if (!parsed) return bad_header(kMrtrix, "wrong transform", row);
    numbers.insert(numbers.end(), parsed->begin(), parsed->end());
  }
  if (numbers.size() != 12 && numbers.size() != 16) {
    return bad_header(kMrtrix, "wrong transform", found->second.front());
  }
  size_t next = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) transform[column][row] = numbers[next++];
  }
  return transform;
}

struct ImageAxes {
  std::vector<uint64_t> sizes;
  std::vector<double> spacing;
  std::vector<StoredAxis> layout;
};

Result<ImageAxes> parse_axes(const KeyLines& keys) {
  const auto sizes = counts_of(with_spaces(value_of(keys, "dim")));
  const auto spacing = numbers_of(with_spaces(value_of(keys, "vox")));
  if (!sizes || sizes->empty()) return bad_header(kMrtrix, "wrong sizes", value_of(keys, "dim"));
  if (!spacing || spacing->size() < std::min<size_t>(3, sizes->size())) {
    return bad_header(kMrtrix, "wrong sizes of voxels", value_of(keys, "vox"));
  }
  Result<std::vector<StoredAxis>> layout = parse_layout(value_of(keys, "layout"), sizes->size());
  if (!layout) return fail(layout);
  ImageAxes axes{*sizes, *spacing, std::move(*layout)};
  while (axes.sizes.size() < 4) {
    axes.sizes.push_back(1);
    axes.layout.push_back({static_cast<int64_t>(axes.layout.size()), false});
  }
  axes.spacing.resize(axes.sizes.size(), 1);
  return axes;
}

/// Whether the components come first or last, and what they are.
Status take_components(const ImageAxes& axes, StoredGrid& grid) {
  for (size_t axis = 4; axis < axes.sizes.size(); ++axis) {
    if (axes.sizes[axis] != 1) return fail(ErrorKind::kUnsupported, "MRtrix: more than four axes");
  }
  if (axes.sizes[3] == 1) return {};
  if (axes.sizes[3] != kTensorImages) {
    return fail(ErrorKind::kUnsupported,
                "MRtrix: a series of " + std::to_string(axes.sizes[3]) + " images; one is read, or six of a tensor");
  }
  const int64_t rank = axes.layout[3].rank;
  const bool first = rank == 0;
  const bool last = std::none_of(axes.layout.begin(), axes.layout.begin() + 3,
                                 [rank](const StoredAxis& axis) { return axis.rank > rank; });
  if ((!first && !last) || axes.layout[3].backward) {
    return fail(ErrorKind::kUnsupported,
                "MRtrix: the axis of components lies between axes of space; convert with mrconvert -strides 1,2,3,4");
  }
  grid.header.kind = SampleKind::kSymmetricTensorMrtrix;
  grid.planar = !first;
  return {};
}

/// Sizes and steps of the three axes in the order of storage, and the first stored sample.
void place(const ImageAxes& axes, const glm::dmat4x3& transform, GridHeader& header) {
  std::array<size_t, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return axes.layout[a].rank < axes.layout[b].rank; });
  glm::dvec3 origin = transform[3];
  for (size_t i = 0; i < 3; ++i) {
    const size_t axis = order.at(i);
    const glm::dvec3 step = axes.spacing[axis] * transform[static_cast<int>(axis)];
    const bool backward = axes.layout[axis].backward;
    header.size.at(i) = axes.sizes[axis];
    header.index_to_world[static_cast<int>(i)] = backward ? -step : step;
    if (backward) origin += static_cast<double>(axes.sizes[axis] - std::min<uint64_t>(axes.sizes[axis], 1)) * step;
  }
  header.index_to_world[3] = origin;
  header.frame = WorldFrame::kRas;
  header.length_unit = "mm";
}

/// "offset,scale".
Status take_scaling(const KeyLines& keys, GridHeader& header) {
  const std::string_view text = value_of(keys, "scaling");
  if (text.empty()) return {};
  const auto numbers = numbers_of(with_spaces(text));
  if (!numbers || numbers->size() != 2) return bad_header(kMrtrix, "wrong scaling", text);
  header.intercept = (*numbers)[0];
  header.slope = (*numbers)[1];
  return {};
}

/// Where the samples are: "file: . OFFSET", or the name of another file.
Status store_samples(const KeyLines& keys, const GridFile& file, StoredGrid& grid) {
  const std::string_view text = value_of(keys, "file");
  const std::vector<std::string_view> words = words_of(text);
  const auto offset = words.size() > 1 ? scan::parse_number<int64_t>(words[1]) : std::optional<int64_t>(0);
  if (words.empty() || !offset || *offset < 0) return bad_header(kMrtrix, "wrong place of the samples", text);
  StoredSamples samples;
  samples.type = grid.header.type;
  samples.bytes = grid.header.samples() * grid.header.sample_bytes();
  samples.byte_skip = *offset;
  FilePtr data = file.file;
  if (words[0] != ".") {
    const Result<std::filesystem::path> path = beside(file.path, words[0]);
    if (!path) return fail(path);
    Result<FilePtr> opened = stream::open_shared(*path);
    if (!opened) return fail(opened);
    data = std::move(*opened);
    grid.data_files = 1;
    grid.data_file = [path = *path](uint64_t) { return path; };
  }
  samples.packing = stream::is_gzip(data->bytes()) ? Packing::kInflate : Packing::kRaw;
  samples.file = std::move(data);
  grid.open = [samples = std::move(samples)] { return open_samples(samples); };
  return {};
}

Result<StoredGrid> describe_mrtrix(const KeyLines& keys) {
  StoredGrid grid;
  grid.header.format = kMrtrix;
  const Result<ImageAxes> axes = parse_axes(keys);
  if (!axes) return fail(axes);
  const Result<SampleType> type = parse_mrtrix_type(value_of(keys, "datatype"));
  if (!type) return fail(type);
  grid.header.type = type->type;
  grid.swapped = type->swapped;
  const Result<glm::dmat4x3> transform = parse_transform(keys);
  if (!transform) return fail(transform);
  if (Status status = take_components(*axes, grid); !status) return fail(status);
  place(*axes, *transform, grid.header);
  if (Status status = take_scaling(keys, grid.header); !status) return fail(status);
  if (Status status = check_header(grid.header); !status) return fail(status);
  return grid;
}

}  // namespace

bool looks_like_mrtrix(const FilePtr& file) {
  if (!stream::is_gzip(file->bytes())) return scan::as_text(file->bytes()).starts_with(kMagic);
  return head_of(file, kMagic.size()) == kMagic;
}

Result<StoredGrid> parse_mrtrix(const GridFile& file) {
  const std::string head = head_of(file.file, kMaxHeader);
  const Result<KeyLines> keys = split_mrtrix_header(head);
  if (!keys) return fail(keys);
  Result<StoredGrid> grid = describe_mrtrix(*keys);
  if (!grid) return grid;
  if (Status status = store_samples(*keys, file, *grid); !status) return fail(status);
  return grid;
}

}  // namespace surfcast::grid
