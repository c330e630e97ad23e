#include "grid/nrrd.h"

#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "grid/header_text.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {
namespace {

constexpr std::string_view kFormat = "NRRD";

/// The names of fields in small letters without spaces, in which spellings differ.
using Fields = std::map<std::string, std::string, std::less<>>;

struct NrrdText {
  Fields fields;
  std::vector<std::string> files;  ///< after "data file: LIST"
  bool attached = true;
  size_t data_offset = 0;
};

std::string field_name(std::string_view text) {
  std::string name;
  for (const char c : lower_case(text)) {
    if (!scan::is_space(c)) name += c;
  }
  if (name == "centerings") name = "centers";
  return name;
}

/// Lines after "data file: LIST" are names of files. The header ends at an empty line, or with the file.
Result<NrrdText> split_header(std::string_view text) {
  HeaderLines lines(text);
  lines.next();  // "NRRD000N"
  NrrdText header;
  bool list = false;
  std::optional<std::string_view> line = lines.next();
  for (; line && !line->empty(); line = lines.next()) {
    if (list) {
      header.files.emplace_back(trimmed(*line));
      continue;
    }
    const size_t colon = line->find(':');
    if (line->starts_with('#') || line->substr(colon == std::string_view::npos ? 0 : colon).starts_with(":=")) continue;
    if (colon == std::string_view::npos) return bad_header(kFormat, "line not understood", *line);
    const std::string name = field_name(line->substr(0, colon));
    header.fields[name] = trimmed(line->substr(colon + 1));
    list = name == "datafile" && header.fields[name].starts_with("LIST");
  }
  header.attached = !header.fields.contains("datafile");
  header.data_offset = lines.offset();
  if (header.attached && !line) return fail(ErrorKind::kInvalidInput, "truncated: NRRD header without an end");
  return header;
}

std::string_view field(const Fields& fields, std::string_view name) {
  const auto at = fields.find(name);
  return at == fields.end() ? std::string_view() : std::string_view(at->second);
}

Result<ScalarType> parse_type(std::string_view text) {
  static const std::map<std::string, ScalarType, std::less<>> kTypes = {
      {"signed char", ScalarType::kInt8},
      {"int8", ScalarType::kInt8},
      {"int8_t", ScalarType::kInt8},
      {"uchar", ScalarType::kUint8},
      {"unsigned char", ScalarType::kUint8},
      {"uint8", ScalarType::kUint8},
      {"uint8_t", ScalarType::kUint8},
      {"short", ScalarType::kInt16},
      {"short int", ScalarType::kInt16},
      {"signed short", ScalarType::kInt16},
      {"signed short int", ScalarType::kInt16},
      {"int16", ScalarType::kInt16},
      {"int16_t", ScalarType::kInt16},
      {"ushort", ScalarType::kUint16},
      {"unsigned short", ScalarType::kUint16},
      {"unsigned short int", ScalarType::kUint16},
      {"uint16", ScalarType::kUint16},
      {"uint16_t", ScalarType::kUint16},
      {"int", ScalarType::kInt32},
      {"signed int", ScalarType::kInt32},
      {"int32", ScalarType::kInt32},
      {"int32_t", ScalarType::kInt32},
      {"uint", ScalarType::kUint32},
      {"unsigned int", ScalarType::kUint32},
      {"uint32", ScalarType::kUint32},
      {"uint32_t", ScalarType::kUint32},
      {"longlong", ScalarType::kInt64},
      {"long long", ScalarType::kInt64},
      {"long long int", ScalarType::kInt64},
      {"signed long long", ScalarType::kInt64},
      {"signed long long int", ScalarType::kInt64},
      {"int64", ScalarType::kInt64},
      {"int64_t", ScalarType::kInt64},
      {"ulonglong", ScalarType::kUint64},
      {"unsigned long long", ScalarType::kUint64},
      {"unsigned long long int", ScalarType::kUint64},
      {"uint64", ScalarType::kUint64},
      {"uint64_t", ScalarType::kUint64},
      {"float", ScalarType::kFloat32},
      {"double", ScalarType::kFloat64},
  };
  const auto type = kTypes.find(lower_case(text));
  if (type == kTypes.end()) return bad_header(kFormat, "unknown type of samples", text);
  return type->second;
}

/// The axes of the array, as far as fields speak of them.
struct Axes {
  std::vector<uint64_t> sizes;
  std::vector<std::string> kinds;                     ///< in small letters; empty where not stated
  std::vector<std::optional<glm::dvec3>> directions;  ///< empty without "space directions"
  std::vector<double> spacings;                       ///< NaN where not stated
  std::vector<double> mins;
  std::vector<double> maxs;
  std::vector<bool> cells;
};

/// Vectors "(a,b,c)" and words "none", for axes or for the origin. Vectors of a plane get the third coordinate 0.
Result<std::vector<std::optional<glm::dvec3>>> parse_vectors(std::string_view text, size_t dimension) {
  std::vector<std::optional<glm::dvec3>> vectors;
  for (std::string_view rest = trimmed(text); !rest.empty(); rest = trimmed(rest)) {
    if (!rest.starts_with('(')) {
      const std::string_view word = scan::Tokens(rest).next();
      if (lower_case(word) != "none") return bad_header(kFormat, "not a vector", rest);
      vectors.emplace_back(std::nullopt);
      rest.remove_prefix(word.size());
      continue;
    }
    const size_t end = rest.find(')');
    if (end == std::string_view::npos) return bad_header(kFormat, "not a vector", rest);
    std::string inner(rest.substr(1, end - 1));
    for (char& c : inner) c = c == ',' ? ' ' : c;
    const auto numbers = numbers_of(inner);
    if (!numbers || numbers->size() != dimension) return bad_header(kFormat, "not a vector of the space", rest);
    glm::dvec3 vector(0);
    for (size_t i = 0; i < dimension; ++i) vector[static_cast<int>(i)] = (*numbers)[i];
    vectors.emplace_back(vector);
    rest.remove_prefix(end + 1);
  }
  return vectors;
}

/// Numbers for all axes, NaN where the field is missing.
Result<std::vector<double>> per_axis(const Fields& fields, std::string_view name, size_t axes) {
  if (!fields.contains(name)) return std::vector<double>(axes, std::numeric_limits<double>::quiet_NaN());
  auto numbers = numbers_of(field(fields, name));
  if (!numbers || numbers->size() != axes)
    return bad_header(kFormat, "not a number for each axis", field(fields, name));
  return std::move(*numbers);
}

struct Space {
  size_t dimension = 3;
  WorldFrame frame = WorldFrame::kUnstated;
};

Result<Space> parse_space(const Fields& fields) {
  static const std::map<std::string, WorldFrame, std::less<>> kSpaces = {
      {"right-anterior-superior", WorldFrame::kRas}, {"ras", WorldFrame::kRas},
      {"left-anterior-superior", WorldFrame::kLas},  {"las", WorldFrame::kLas},
      {"left-posterior-superior", WorldFrame::kLps}, {"lps", WorldFrame::kLps},
      {"scanner-xyz", WorldFrame::kUnstated},        {"3d-right-handed", WorldFrame::kUnstated},
      {"3d-left-handed", WorldFrame::kUnstated},
  };
  Space space;
  if (const std::string_view name = field(fields, "space"); !name.empty()) {
    const auto known = kSpaces.find(lower_case(name));
    if (known == kSpaces.end()) {
      return fail(ErrorKind::kUnsupported, "NRRD: not a space of three dimensions: " + scan::printable(name));
    }
    space.frame = known->second;
  }
  if (const std::string_view text = field(fields, "spacedimension"); !text.empty()) {
    const auto dimension = scan::parse_number<uint64_t>(text);
    if (!dimension || *dimension < 1) return bad_header(kFormat, "not a dimension", text);
    if (*dimension > 3) return fail(ErrorKind::kUnsupported, "NRRD: a space of more than three dimensions");
    space.dimension = *dimension;
  }
  return space;
}

Status parse_kinds(const Fields& fields, Axes& axes) {
  axes.kinds.resize(axes.sizes.size());
  axes.cells.resize(axes.sizes.size());
  const auto take = [&](std::string_view name, auto&& use) -> Status {
    const auto words = words_of(field(fields, name));
    if (words.empty()) return {};
    if (words.size() != axes.sizes.size()) {
      return bad_header(kFormat, "not a word for each axis", field(fields, name));
    }
    for (size_t i = 0; i < words.size(); ++i) use(i, lower_case(words[i]));
    return {};
  };
  if (Status status = take("kinds", [&](size_t i, std::string word) { axes.kinds[i] = std::move(word); }); !status) {
    return status;
  }
  return take("centers", [&](size_t i, const std::string& word) { axes.cells[i] = word == "cell"; });
}

Result<Axes> parse_axes(const Fields& fields, const Space& space) {
  Axes axes;
  const auto dimension = scan::parse_number<uint64_t>(field(fields, "dimension"));
  auto sizes = counts_of(field(fields, "sizes"));
  if (!dimension) return bad_header(kFormat, "not a dimension", field(fields, "dimension"));
  if (!sizes || sizes->size() != *dimension || sizes->empty()) {
    return bad_header(kFormat, "not a size for each axis", field(fields, "sizes"));
  }
  axes.sizes = std::move(*sizes);
  if (Status status = parse_kinds(fields, axes); !status) return fail(std::move(status.error()));
  for (const auto& [name, into] :
       {std::pair{"spacings", &axes.spacings}, {"axismins", &axes.mins}, {"axismaxs", &axes.maxs}}) {
    Result<std::vector<double>> numbers = per_axis(fields, name, axes.sizes.size());
    if (!numbers) return fail(std::move(numbers.error()));
    *into = std::move(*numbers);
  }
  if (!fields.contains("spacedirections")) return axes;
  auto directions = parse_vectors(field(fields, "spacedirections"), space.dimension);
  if (!directions) return fail(std::move(directions.error()));
  if (directions->size() != axes.sizes.size()) {
    return bad_header(kFormat, "not a direction for each axis", field(fields, "spacedirections"));
  }
  axes.directions = std::move(*directions);
  return axes;
}

/// Kinds of axes along which a grid extends. An axis without a kind extends unless its direction is "none".
bool is_domain(const Axes& axes, size_t axis) {
  const std::string& kind = axes.kinds[axis];
  if (kind == "space" || kind == "domain") return true;
  if (!kind.empty() && kind != "???" && kind != "none") return false;
  return axes.directions.empty() || axes.directions[axis].has_value();
}

std::optional<SampleKind> tensor_named(std::string_view kind) {
  if (kind == "3d-symmetric-matrix") return SampleKind::kSymmetricTensor;
  if (kind == "3d-masked-symmetric-matrix") return SampleKind::kMaskedSymmetricTensor;
  if (kind == "3d-matrix") return SampleKind::kTensor;
  if (kind == "3d-masked-matrix") return SampleKind::kMaskedTensor;
  return std::nullopt;
}

/// What the components on this axis are. Only tensors have several.
Result<SampleKind> kind_of_axis(const Axes& axes, size_t axis) {
  if (axes.sizes[axis] == 1) return SampleKind::kScalar;
  const std::string& kind = axes.kinds[axis];
  const std::optional<SampleKind> tensor = tensor_named(kind);
  if (tensor && components_of(*tensor) == axes.sizes[axis]) return *tensor;
  const std::string named = kind.empty() ? "of no stated kind" : "of kind " + scan::printable(kind);
  return fail(ErrorKind::kUnsupported, "NRRD: samples of " + std::to_string(axes.sizes[axis]) + " components " + named +
                                           "; only scalars and tensors are read");
}

/// Assigns axes to i, j, k and the components. Returns the axes of i, j and k.
Result<std::vector<size_t>> domain_of(const Axes& axes, StoredGrid& grid) {
  std::vector<size_t> domain;
  for (size_t axis = 0; axis < axes.sizes.size(); ++axis) {
    const bool extends = is_domain(axes, axis) && (domain.size() < 3 || axes.sizes[axis] != 1);
    if (extends && domain.size() == 3) {
      return fail(ErrorKind::kUnsupported, "NRRD: more than three axes of space, " + std::to_string(axes.sizes[axis]) +
                                               " samples along another; only scalars and tensors are read");
    }
    if (extends) {
      domain.push_back(axis);
      continue;
    }
    const Result<SampleKind> kind = kind_of_axis(axes, axis);
    if (!kind) return fail(kind.error());
    if (*kind == SampleKind::kScalar) continue;
    const bool last = axis + 1 == axes.sizes.size();
    if (grid.header.kind != SampleKind::kScalar || (axis > 0 && !last)) {
      return fail(ErrorKind::kUnsupported, "NRRD: components between axes of space; put them first or last");
    }
    grid.header.kind = *kind;
    grid.planar = axis > 0;
  }
  return domain;
}

/// The step along an axis, and the position of its first sample, without a space.
std::pair<double, double> spacing_and_start(const Axes& axes, size_t axis) {
  const double min = axes.mins[axis];
  const double max = axes.maxs[axis];
  const bool cell = axes.cells[axis];
  double spacing = axes.spacings[axis];
  if (!std::isfinite(spacing) && std::isfinite(max - min)) {
    spacing = (max - min) / (static_cast<double>(axes.sizes[axis]) - (cell ? 0 : 1));
  }
  if (std::isnan(spacing)) spacing = 1;
  const double start = std::isfinite(min) ? min + (cell ? 0.5 * spacing : 0) : 0;
  return {spacing, start};
}

/// A step for an axis that a line or a picture does not have: across the others, of length 1.
glm::dvec3 missing_step(const std::vector<glm::dvec3>& steps) {
  if (steps.size() == 2) return glm::normalize(glm::cross(steps[0], steps[1]));
  const glm::dvec3 a = glm::abs(steps[0]);
  const glm::dvec3 least = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                           : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                    : glm::dvec3(0, 0, 1);
  return glm::normalize(glm::cross(steps[0], least));
}

Status place(const Fields& fields, const Space& space, const Axes& axes, const std::vector<size_t>& domain,
             GridHeader& header) {
  std::vector<glm::dvec3> steps;
  glm::dvec3 origin(0);
  for (size_t i = 0; i < domain.size(); ++i) {
    header.size[i] = axes.sizes[domain[i]];
    const auto [spacing, start] = spacing_and_start(axes, domain[i]);
    glm::dvec3 step(0);
    step[static_cast<int>(i)] = spacing;
    origin[static_cast<int>(i)] = start;
    steps.push_back(axes.directions.empty() ? step : axes.directions[domain[i]].value_or(glm::dvec3(0)));
  }
  while (steps.size() < 3) {
    header.size[steps.size()] = 1;
    steps.push_back(missing_step(steps));
  }
  if (!axes.directions.empty()) origin = glm::dvec3(0);
  if (const std::string_view text = field(fields, "spaceorigin"); !text.empty()) {
    const auto vectors = parse_vectors(text, space.dimension);
    if (!vectors) return fail(vectors.error());
    if (vectors->size() != 1 || !vectors->front()) return bad_header(kFormat, "not an origin", text);
    origin = *vectors->front();
  }
  header.index_to_world = glm::dmat4x3(steps[0], steps[1], steps[2], origin);
  return {};
}

Status parse_measurement_frame(const Fields& fields, GridHeader& header) {
  const std::string_view text = field(fields, "measurementframe");
  if (text.empty()) return {};
  const auto vectors = parse_vectors(text, 3);
  if (!vectors) return fail(vectors.error());
  if (vectors->size() != 3 || !(*vectors)[0] || !(*vectors)[1] || !(*vectors)[2]) {
    return bad_header(kFormat, "not a measurement frame", text);
  }
  header.measurement_frame = glm::dmat3(*(*vectors)[0], *(*vectors)[1], *(*vectors)[2]);
  return {};
}

Result<Packing> parse_encoding(std::string_view text) {
  const std::string name = lower_case(text);
  if (name == "raw") return Packing::kRaw;
  if (name == "text" || name == "txt" || name == "ascii") return Packing::kText;
  if (name == "gzip" || name == "gz") return Packing::kInflate;
  if (name == "bzip2" || name == "bz2") return Packing::kBzip2;
  return fail(ErrorKind::kUnsupported, "NRRD: the encoding is not supported: " + scan::printable(text));
}

/// Whether bytes are in the other order. One-byte samples have no order, and text has none.
Result<bool> parse_endian(const Fields& fields, ScalarType type, Packing packing) {
  if (scan::size_of(type) == 1 || packing == Packing::kText) return false;
  const std::string name = lower_case(field(fields, "endian"));
  if (name == "big") return std::endian::native != std::endian::big;
  if (name == "little") return std::endian::native != std::endian::little;
  return bad_header(kFormat, "no byte order, which samples of this type need", name);
}

Status parse_skips(const Fields& fields, StoredSamples& samples) {
  if (const std::string_view text = field(fields, "lineskip"); !text.empty()) {
    const auto lines = scan::parse_number<uint64_t>(text);
    if (!lines) return bad_header(kFormat, "not a number of lines", text);
    samples.line_skip = *lines;
  }
  if (const std::string_view text = field(fields, "byteskip"); !text.empty()) {
    const auto bytes = scan::parse_number<int64_t>(text);
    if (!bytes || *bytes < -1) return bad_header(kFormat, "not a number of bytes", text);
    samples.byte_skip = *bytes;
  }
  return {};
}

/// The data files that the header names: one, a list, or a pattern.
Status find_files(const NrrdText& text, const GridFile& file, StoredSamples& samples) {
  const std::string_view name = field(text.fields, "datafile");
  if (text.attached) {
    samples.file = file.file;
    samples.offset = text.data_offset;
    return {};
  }
  Result<std::optional<FilePattern>> pattern = parse_pattern(file.path, name);
  if (!pattern) return fail(std::move(pattern.error()));
  if (*pattern) {
    samples.files = (**pattern).count;
    samples.name = [found = std::move(**pattern)](uint64_t i) { return found.name(i); };
    return {};
  }
  const std::vector<std::string> names = name.starts_with("LIST") ? text.files : std::vector{std::string(name)};
  std::vector<std::filesystem::path> paths;
  for (const std::string& one : names) {
    Result<std::filesystem::path> path = beside(file.path, one);
    if (!path) return fail(std::move(path.error()));
    paths.push_back(std::move(*path));
  }
  samples.files = paths.size();
  samples.name = [found = std::move(paths)](uint64_t i) { return found[i]; };
  return {};
}

/// Units are quoted words, one for each axis of the space; they agree in practice.
std::string unit_of(std::string_view text) {
  const size_t first = text.find('"');
  if (first == std::string_view::npos) return std::string(scan::Tokens(text).next());
  return std::string(text.substr(first + 1, text.find('"', first + 1) - first - 1));
}

Result<StoredGrid> describe(const Fields& fields) {
  StoredGrid grid;
  GridHeader& header = grid.header;
  header.format = kFormat;
  header.name = scan::printable(field(fields, "content"));
  const Result<Space> space = parse_space(fields);
  if (!space) return fail(space.error());
  const Result<ScalarType> type = parse_type(field(fields, "type"));
  if (!type) return fail(type.error());
  const Result<Axes> axes = parse_axes(fields, *space);
  if (!axes) return fail(axes.error());
  const Result<std::vector<size_t>> domain = domain_of(*axes, grid);
  if (!domain) return fail(domain.error());
  if (domain->empty()) return fail(ErrorKind::kInvalidInput, "NRRD: no axis of space");
  header.type = *type;
  header.frame = space->frame;
  header.length_unit = scan::printable(unit_of(field(fields, fields.contains("spaceunits") ? "spaceunits" : "units")));
  header.sample_unit = scan::printable(field(fields, "sampleunits"));
  if (Status status = place(fields, *space, *axes, *domain, header); !status) return fail(std::move(status.error()));
  if (Status status = parse_measurement_frame(fields, header); !status) return fail(std::move(status.error()));
  return grid;
}

}  // namespace

Result<StoredGrid> parse_nrrd(const GridFile& file) {
  const Result<NrrdText> text = split_header(file.text());
  if (!text) return fail(text.error());
  Result<StoredGrid> grid = describe(text->fields);
  if (!grid) return grid;
  if (Status status = check_header(grid->header); !status) return fail(std::move(status.error()));
  StoredSamples samples;
  const Result<Packing> packing = parse_encoding(field(text->fields, "encoding"));
  if (!packing) return fail(packing.error());
  const Result<bool> swapped = parse_endian(text->fields, grid->header.type, *packing);
  if (!swapped) return fail(swapped.error());
  grid->swapped = *swapped;
  samples.packing = *packing;
  samples.type = grid->header.type;
  samples.bytes = grid->header.samples() * grid->header.sample_bytes();
  if (Status status = parse_skips(text->fields, samples); !status) return fail(std::move(status.error()));
  if (Status status = find_files(*text, file, samples); !status) return fail(std::move(status.error()));
  grid->open = [samples = std::move(samples)] { return open_samples(samples); };
  return grid;
}

}  // namespace surfcast::grid
