#include <bit>
#include <map>
#include <utility>
#include <vector>

#include "base/ascii_text.h"
#include "grid/header_text.h"
#include "grid/nrrd_axes.h"
#include "grid/nrrd_text.h"
#include "grid/readers.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {
namespace {

Result<ScalarType> parse_nrrd_type(std::string_view text) {
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
  const auto type = kTypes.find(to_lower(text));
  if (type == kTypes.end()) return bad_header(kNrrd, "unknown type of samples", text);
  return type->second;
}

Result<Packing> parse_encoding(std::string_view text) {
  const std::string name = to_lower(text);
  if (name == "raw") return Packing::kRaw;
  if (name == "text" || name == "txt" || name == "ascii") return Packing::kText;
  if (name == "gzip" || name == "gz") return Packing::kInflate;
  if (name == "bzip2" || name == "bz2") return Packing::kBzip2;
  return fail(ErrorKind::kUnsupported, "NRRD: the encoding is not supported: " + scan::printable(text));
}

/// Whether bytes are in the other order. One-byte samples have no order, and text has none.
Result<bool> parse_endian(const NrrdFields& fields, ScalarType type, Packing packing) {
  if (scan::size_of(type) == 1 || packing == Packing::kText) return false;
  const std::string name = to_lower(field(fields, "endian"));
  if (name == "big") return std::endian::native != std::endian::big;
  if (name == "little") return std::endian::native != std::endian::little;
  return bad_header(kNrrd, "no byte order, which samples of this type need", name);
}

Status parse_skips(const NrrdFields& fields, StoredSamples& samples) {
  if (const std::string_view text = field(fields, "lineskip"); !text.empty()) {
    const auto lines = scan::parse_number<uint64_t>(text);
    if (!lines) return bad_header(kNrrd, "not a number of lines", text);
    samples.line_skip = *lines;
  }
  if (const std::string_view text = field(fields, "byteskip"); !text.empty()) {
    const auto bytes = scan::parse_number<int64_t>(text);
    if (!bytes || *bytes < -1) return bad_header(kNrrd, "not a number of bytes", text);
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
  if (!pattern) return fail(pattern);
  if (*pattern) {
    samples.files = (**pattern).count;
    samples.name = [found = std::move(**pattern)](uint64_t i) { return found.name(i); };
    return {};
  }
  const std::vector<std::string> names = name.starts_with("LIST") ? text.files : std::vector{std::string(name)};
  std::vector<std::filesystem::path> paths;
  for (const std::string& one : names) {
    Result<std::filesystem::path> path = beside(file.path, one);
    if (!path) return fail(path);
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

Result<StoredGrid> describe_nrrd(const NrrdFields& fields) {
  StoredGrid grid;
  GridHeader& header = grid.header;
  header.format = kNrrd;
  header.name = scan::printable(field(fields, "content"));
  const Result<NrrdSpace> space = parse_space(fields);
  if (!space) return fail(space);
  const Result<ScalarType> type = parse_nrrd_type(field(fields, "type"));
  if (!type) return fail(type);
  const Result<NrrdAxes> axes = parse_axes(fields, *space);
  if (!axes) return fail(axes);
  const Result<std::vector<size_t>> domain = domain_of(*axes, grid);
  if (!domain) return fail(domain);
  if (domain->empty()) return fail(ErrorKind::kInvalidInput, "NRRD: no axis of space");
  header.type = *type;
  header.frame = space->frame;
  header.length_unit = scan::printable(unit_of(field(fields, fields.contains("spaceunits") ? "spaceunits" : "units")));
  header.sample_unit = scan::printable(field(fields, "sampleunits"));
  if (Status status = place(fields, *space, *axes, *domain, header); !status) return fail(status);
  if (Status status = parse_measurement_frame(fields, header); !status) return fail(status);
  return grid;
}

}  // namespace

Result<StoredGrid> parse_nrrd(const GridFile& file) {
  const Result<NrrdText> text = split_nrrd(file.text());
  if (!text) return fail(text);
  Result<StoredGrid> grid = describe_nrrd(text->fields);
  if (!grid) return grid;
  if (Status status = check_header(grid->header); !status) return fail(status);
  StoredSamples samples;
  const Result<Packing> packing = parse_encoding(field(text->fields, "encoding"));
  if (!packing) return fail(packing);
  const Result<bool> swapped = parse_endian(text->fields, grid->header.type, *packing);
  if (!swapped) return fail(swapped);
  grid->swapped = *swapped;
  samples.packing = *packing;
  samples.type = grid->header.type;
  samples.bytes = grid->header.samples() * grid->header.sample_bytes();
  if (Status status = parse_skips(text->fields, samples); !status) return fail(status);
  if (Status status = find_files(*text, file, samples); !status) return fail(status);
  store(std::move(samples), *grid);
  return grid;
}

}  // namespace surfcast::grid
