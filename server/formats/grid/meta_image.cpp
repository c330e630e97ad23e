#include <algorithm>
#include <bit>
#include <map>
#include <utility>
#include <vector>

#include "base/ascii_text.h"
#include "grid/header_text.h"
#include "grid/readers.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {
namespace {

constexpr std::string_view kMetaImage = "MetaImage";

/// Keys in small letters.
using Keys = std::map<std::string, std::string, std::less<>>;

struct MetaText {
  Keys keys;
  std::string data_file;
  size_t after = 0;  ///< of the line with the data file
};

std::optional<std::pair<std::string, std::string>> split_line(std::string_view line) {
  const size_t equals = line.find('=');
  if (equals == std::string_view::npos) return std::nullopt;
  return std::pair(to_lower(trimmed(line.substr(0, equals))), std::string(trimmed(line.substr(equals + 1))));
}

/// ElementDataFile is the last key.
Result<MetaText> split_header(std::string_view text) {
  HeaderLines lines(text);
  MetaText header;
  while (const std::optional<std::string_view> line = lines.next()) {
    if (trimmed(*line).empty()) continue;
    auto entry = split_line(*line);
    if (!entry) return bad_header(kMetaImage, "line not understood", *line);
    if (entry->first == "elementdatafile") {
      header.data_file = std::move(entry->second);
      header.after = lines.offset();
      return header;
    }
    header.keys.insert_or_assign(std::move(entry->first), std::move(entry->second));
  }
  return fail(ErrorKind::kInvalidInput, "truncated: MetaImage header without ElementDataFile");
}

/// The value of the first of these keys that is there.
std::string_view value_of(const Keys& keys, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    if (const auto at = keys.find(name); at != keys.end()) return at->second;
  }
  return {};
}

bool is_true(std::string_view text) {
  const std::string word = to_lower(text);
  return word == "true" || word == "1" || word == "yes";
}

/// MetaIO's long has four bytes on every machine.
Result<ScalarType> parse_meta_image_type(std::string_view text) {
  static const std::map<std::string, ScalarType, std::less<>> kTypes = {
      {"MET_CHAR", ScalarType::kInt8},       {"MET_UCHAR", ScalarType::kUint8},
      {"MET_SHORT", ScalarType::kInt16},     {"MET_USHORT", ScalarType::kUint16},
      {"MET_INT", ScalarType::kInt32},       {"MET_UINT", ScalarType::kUint32},
      {"MET_LONG", ScalarType::kInt32},      {"MET_ULONG", ScalarType::kUint32},
      {"MET_LONG_LONG", ScalarType::kInt64}, {"MET_ULONG_LONG", ScalarType::kUint64},
      {"MET_FLOAT", ScalarType::kFloat32},   {"MET_DOUBLE", ScalarType::kFloat64},
  };
  const auto type = kTypes.find(text);
  if (type == kTypes.end()) return bad_header(kMetaImage, "unknown type of samples", text);
  return type->second;
}

/// As many numbers as wanted, or the fallback if the key is missing.
Result<std::vector<double>> numbers(const Keys& keys, std::initializer_list<std::string_view> names,
                                    std::vector<double> fallback) {
  const std::string_view text = value_of(keys, names);
  if (text.empty()) return fallback;
  auto values = numbers_of(text);
  if (!values || values->size() != fallback.size()) return bad_header(kMetaImage, "wrong numbers", text);
  return std::move(*values);
}

std::vector<double> identity(size_t n) {
  std::vector<double> matrix(n * n, 0.0);
  for (size_t i = 0; i < n; ++i) matrix[i * n + i] = 1;
  return matrix;
}

Result<std::vector<uint64_t>> parse_sizes(const Keys& keys) {
  auto sizes = counts_of(value_of(keys, {"dimsize"}));
  const auto dimensions = scan::parse_number<uint64_t>(value_of(keys, {"ndims"}));
  if (!dimensions || !sizes || sizes->size() != *dimensions || sizes->empty()) {
    return bad_header(kMetaImage, "not a size for each dimension", value_of(keys, {"dimsize"}));
  }
  if (std::any_of(sizes->begin() + std::min<ptrdiff_t>(3, std::ssize(*sizes)), sizes->end(),
                  [](uint64_t size) { return size != 1; })) {
    return fail(ErrorKind::kUnsupported, "MetaImage: more than three dimensions; only scalars are read");
  }
  return std::move(*sizes);
}

/// The n numbers from i * n on are the direction of axis i. Dimensions beyond the third have one sample.
Status place(const Keys& keys, const std::vector<uint64_t>& sizes, GridHeader& header) {
  const size_t n = sizes.size();
  const auto spacing = numbers(keys, {"elementspacing", "elementsize"}, std::vector<double>(n, 1.0));
  const auto origin = numbers(keys, {"offset", "position", "origin"}, std::vector<double>(n, 0.0));
  const auto matrix = numbers(keys, {"transformmatrix", "rotation", "orientation"}, identity(n));
  for (const auto* part : {&spacing, &origin, &matrix}) {
    if (!*part) return fail(*part);
  }
  glm::dmat3 directions(1.0);
  glm::dvec3 steps(1.0);
  glm::dvec3 start(0.0);
  header.size = {1, 1, 1};
  for (size_t i = 0; i < std::min<size_t>(n, 3); ++i) {
    const auto axis = static_cast<int>(i);
    header.size[i] = sizes[i];
    steps[axis] = (*spacing)[i];
    start[axis] = (*origin)[i];
    for (size_t j = 0; j < std::min<size_t>(n, 3); ++j) directions[axis][static_cast<int>(j)] = (*matrix)[i * n + j];
  }
  header.index_to_world = affine(directions, steps, start);
  return {};
}

Status parse_scale(const Keys& keys, GridHeader& header) {
  const auto slope = numbers(keys, {"elementtointensityfunctionslope"}, {1.0});
  const auto intercept = numbers(keys, {"elementtointensityfunctionoffset"}, {0.0});
  if (!slope) return fail(slope);
  if (!intercept) return fail(intercept);
  header.slope = slope->front();
  header.intercept = intercept->front();
  return {};
}

Status check_channels(const Keys& keys) {
  const std::string_view channels = value_of(keys, {"elementnumberofchannels"});
  if (channels.empty() || channels == "1") return {};
  return fail(ErrorKind::kUnsupported,
              "MetaImage: samples of " + scan::printable(channels) + " channels; only scalars are read");
}

/// ITK's space is left-posterior-superior; files without an orientation come from elsewhere, too.
WorldFrame parse_frame(const Keys& keys) {
  const std::string_view letters = value_of(keys, {"anatomicalorientation"});
  return letters.empty() || letters.find('?') != std::string_view::npos ? WorldFrame::kUnstated : WorldFrame::kLps;
}

Result<GridHeader> describe_meta_image(const Keys& keys) {
  GridHeader header;
  header.format = kMetaImage;
  header.name = scan::printable(value_of(keys, {"name", "comment"}));
  header.frame = parse_frame(keys);
  header.length_unit = scan::printable(value_of(keys, {"distanceunits"}));
  const Result<std::vector<uint64_t>> sizes = parse_sizes(keys);
  if (!sizes) return fail(sizes);
  const Result<ScalarType> type = parse_meta_image_type(value_of(keys, {"elementtype"}));
  if (!type) return fail(type);
  header.type = *type;
  for (const Status& status : {check_channels(keys), place(keys, *sizes, header), parse_scale(keys, header)}) {
    if (!status) return fail(status);
  }
  if (Status status = check_header(header); !status) return fail(status);
  return header;
}

Packing packing_of(const Keys& keys) {
  if (const std::string_view binary = value_of(keys, {"binarydata"}); !binary.empty() && !is_true(binary)) {
    return Packing::kText;
  }
  return is_true(value_of(keys, {"compresseddata"})) ? Packing::kInflate : Packing::kRaw;
}

/// The names after "ElementDataFile = LIST", a line each.
Result<std::vector<std::filesystem::path>> listed_files(const GridFile& file, size_t from) {
  HeaderLines lines(file.text(), from);
  std::vector<std::filesystem::path> paths;
  while (const std::optional<std::string_view> line = lines.next()) {
    if (trimmed(*line).empty()) continue;
    Result<std::filesystem::path> path = beside(file.path, *line);
    if (!path) return fail(path);
    paths.push_back(std::move(*path));
  }
  return paths;
}

void take_list(std::vector<std::filesystem::path> paths, StoredSamples& samples) {
  samples.files = paths.size();
  samples.name = [found = std::move(paths)](uint64_t i) { return found[i]; };
}

/// The samples: behind the header, in one file, in the files of a list or of a pattern.
Status find_files(const MetaText& text, const GridFile& file, StoredSamples& samples) {
  const std::string_view name = text.data_file;
  if (to_lower(name) == "local") {
    samples.file = file.file;
    samples.offset = text.after;
    return {};
  }
  if (to_lower(scan::Tokens(name).next()) == "list") {
    Result<std::vector<std::filesystem::path>> paths = listed_files(file, text.after);
    if (!paths) return fail(paths);
    take_list(std::move(*paths), samples);
    return {};
  }
  Result<std::optional<FilePattern>> pattern = parse_pattern(file.path, name);
  if (!pattern) return fail(pattern);
  if (*pattern) {
    samples.files = (**pattern).count;
    samples.name = [found = std::move(**pattern)](uint64_t i) { return found.name(i); };
    return {};
  }
  Result<std::filesystem::path> path = beside(file.path, name);
  if (!path) return fail(path);
  take_list({std::move(*path)}, samples);
  return {};
}

Status parse_skip(const Keys& keys, StoredSamples& samples) {
  const std::string_view text = value_of(keys, {"headersize"});
  if (text.empty()) return {};
  const auto bytes = scan::parse_number<int64_t>(text);
  if (!bytes || *bytes < -1) return bad_header(kMetaImage, "not a size of a header", text);
  // A packed file has the header in front of the packed bytes.
  if (samples.packing == Packing::kInflate) {
    samples.offset += static_cast<uint64_t>(std::max<int64_t>(*bytes, 0));
  } else {
    samples.byte_skip = *bytes;
  }
  return {};
}

}  // namespace

bool looks_like_meta_image(std::string_view text) {
  static constexpr std::string_view kFirstKeys[] = {"objecttype", "ndims", "comment", "name", "id"};
  HeaderLines lines(text.substr(0, 256));
  const auto entry = split_line(lines.next().value_or(""));
  const auto* known = entry ? std::find(std::begin(kFirstKeys), std::end(kFirstKeys), entry->first) : nullptr;
  const std::string head = to_lower(text.substr(0, 4096));
  return known != nullptr && known != std::end(kFirstKeys) && head.find("ndims") != std::string::npos;
}

Result<StoredGrid> parse_meta_image(const GridFile& file) {
  const Result<MetaText> text = split_header(file.text());
  if (!text) return fail(text);
  Result<GridHeader> header = describe_meta_image(text->keys);
  if (!header) return fail(header);
  StoredSamples samples;
  samples.packing = packing_of(text->keys);
  samples.type = header->type;
  samples.bytes = header->samples() * header->sample_bytes();
  if (Status status = find_files(*text, file, samples); !status) return fail(status);
  if (Status status = parse_skip(text->keys, samples); !status) return fail(status);
  const bool big = is_true(value_of(text->keys, {"binarydatabyteordermsb", "elementbyteordermsb"}));
  StoredGrid grid;
  grid.header = std::move(*header);
  grid.swapped = samples.packing != Packing::kText && big != (std::endian::native == std::endian::big);
  store(std::move(samples), grid);
  return grid;
}

}  // namespace surfcast::grid
