#include "grid/vtk_legacy.h"

#include <bit>
#include <utility>
#include <vector>

#include "grid/header_text.h"
#include "grid/vtk_arrays.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {
namespace {

constexpr std::string_view kFormat = "VTK";

/// An array and where its numbers are.
struct LegacyArray {
  VtkArray facts;
  ScalarType type = ScalarType::kUint8;
  uint64_t values = 0;
  size_t offset = 0;
};

struct LegacyGrid {
  bool binary = false;
  std::array<uint64_t, 3> points{};
  glm::dvec3 spacing{1.0};
  glm::dvec3 origin{0.0};
  std::vector<LegacyArray> arrays;
};

Result<ScalarType> parse_type(std::string_view text) {
  static constexpr std::pair<std::string_view, ScalarType> kTypes[] = {
      {"unsigned_char", ScalarType::kUint8}, {"char", ScalarType::kInt8},
      {"signed_char", ScalarType::kInt8},    {"unsigned_short", ScalarType::kUint16},
      {"short", ScalarType::kInt16},         {"unsigned_int", ScalarType::kUint32},
      {"int", ScalarType::kInt32},           {"unsigned_long", ScalarType::kUint64},
      {"long", ScalarType::kInt64},          {"vtktypeuint64", ScalarType::kUint64},
      {"vtktypeint64", ScalarType::kInt64},  {"float", ScalarType::kFloat32},
      {"double", ScalarType::kFloat64},
  };
  const std::string name = lower_case(text);
  for (const auto& [known, type] : kTypes) {
    if (known == name) return type;
  }
  return bad_header(kFormat, "type of numbers not supported", text);
}

/// Goes through the file section by section. The numbers of an array are passed over, not read.
class LegacyParser {
 public:
  explicit LegacyParser(std::string_view text) : text_(text), lines_(text) {}

  Result<LegacyGrid> parse() {
    lines_.next();  // "# vtk DataFile Version"
    lines_.next();  // a title
    const std::string encoding = lower_case(next_filled_line());
    if (encoding != "ascii" && encoding != "binary") return bad_header(kFormat, "neither ASCII nor BINARY", encoding);
    grid_.binary = encoding == "binary";
    while (const std::optional<std::string_view> line = lines_.next()) {
      if (Status status = parse_line(*line); !status) return fail(std::move(status.error()));
    }
    if (!has_dataset_) return fail(ErrorKind::kInvalidInput, "truncated: VTK file without a data set");
    return std::move(grid_);
  }

 private:
  std::string_view next_filled_line() {
    std::string_view line;
    while (line.empty()) {
      const std::optional<std::string_view> next = lines_.next();
      if (!next) break;
      line = trimmed(*next);
    }
    return line;
  }

  Status parse_line(std::string_view line) {
    const std::vector<std::string_view> words = words_of(line);
    if (words.empty()) return {};
    const std::string keyword = lower_case(words[0]);
    if (keyword == "dataset") return check_dataset(line, words);
    if (keyword == "dimensions") return take_dimensions(line, words);
    if (keyword == "spacing" || keyword == "aspect_ratio") return take_vector(line, words, grid_.spacing);
    if (keyword == "origin") return take_vector(line, words, grid_.origin);
    if (keyword == "point_data" || keyword == "cell_data") return begin_data(line, words, keyword == "cell_data");
    if (keyword == "metadata") return skip_metadata();
    return parse_section(line, words, keyword);
  }

  Status check_dataset(std::string_view line, const std::vector<std::string_view>& words) {
    has_dataset_ = true;
    if (words.size() > 1 && lower_case(words[1]) == "structured_points") return {};
    return fail(ErrorKind::kUnsupported, "VTK: not a regular grid: " + scan::printable(line));
  }

  Status take_dimensions(std::string_view line, const std::vector<std::string_view>& words) {
    const auto counts = counts_of(line.substr(line.find(words[0]) + words[0].size()));
    if (!counts || counts->size() != 3) return bad_header(kFormat, "wrong dimensions", line);
    std::copy_n(counts->begin(), 3, grid_.points.begin());
    return {};
  }

  static Status take_vector(std::string_view line, const std::vector<std::string_view>& words, glm::dvec3& into) {
    const auto numbers = numbers_of(line.substr(line.find(words[0]) + words[0].size()));
    if (!numbers || numbers->size() != 3) return bad_header(kFormat, "not three numbers", line);
    into = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
    return {};
  }

  Status begin_data(std::string_view line, const std::vector<std::string_view>& words, bool of_cells) {
    const auto count = words.size() > 1 ? scan::parse_number<uint64_t>(words[1]) : std::nullopt;
    if (!count) return bad_header(kFormat, "no number of samples", line);
    tuples_ = *count;
    of_cells_ = of_cells;
    in_data_ = true;
    return {};
  }

  /// Ends at an empty line.
  Status skip_metadata() {
    while (const std::optional<std::string_view> line = lines_.next()) {
      if (trimmed(*line).empty()) break;
    }
    return {};
  }

  Status parse_section(std::string_view line, const std::vector<std::string_view>& words, const std::string& keyword) {
    const auto word = [&](size_t i) { return i < words.size() ? words[i] : std::string_view(); };
    if (keyword == "field") return parse_fields(line, word(2));
    if (keyword == "lookup_table") return skip_lookup_table(line, word(2));
    if (keyword == "color_scalars") {
      return add(line, word(1), word(2), grid_.binary ? "unsigned_char" : "float", tuples_);
    }
    if (keyword == "scalars") {
      if (Status status = skip_table_name(); !status) return status;
      return add(line, word(1), word(3).empty() ? "1" : word(3), word(2), tuples_);
    }
    if (keyword == "texture_coordinates") return add(line, word(1), word(2), word(3), tuples_);
    if (keyword == "vectors" || keyword == "normals") return add(line, word(1), "3", word(2), tuples_);
    if (keyword == "tensors") return add(line, word(1), "9", word(2), tuples_);
    if (keyword == "tensors6") return add(line, word(1), "6", word(2), tuples_);
    if (keyword == "global_ids" || keyword == "pedigree_ids") return add(line, word(1), "1", word(2), tuples_);
    return bad_header(kFormat, "line not understood", line);
  }

  /// The line "LOOKUP_TABLE name" between SCALARS and the numbers, which old writers leave out.
  Status skip_table_name() {
    HeaderLines ahead = lines_;
    const std::optional<std::string_view> line = ahead.next();
    if (line && lower_case(scan::Tokens(*line).next()) == "lookup_table") lines_ = ahead;
    return {};
  }

  /// Four numbers a colour; bytes in binary files.
  Status skip_lookup_table(std::string_view line, std::string_view size) {
    const auto count = scan::parse_number<uint64_t>(size);
    if (!count) return bad_header(kFormat, "no size of a lookup table", line);
    return skip_numbers(stream::saturating(*count, 4, 0), grid_.binary ? ScalarType::kUint8 : ScalarType::kFloat32);
  }

  /// Arrays with lines "name components tuples type".
  Status parse_fields(std::string_view line, std::string_view count_text) {
    const auto count = scan::parse_number<uint64_t>(count_text);
    if (!count) return bad_header(kFormat, "no number of arrays", line);
    for (uint64_t i = 0; i < *count;) {
      const std::optional<std::string_view> next = lines_.next();
      if (!next) return fail(ErrorKind::kInvalidInput, "truncated: the VTK file ends within its arrays");
      const std::vector<std::string_view> words = words_of(*next);
      if (words.empty()) continue;
      if (lower_case(words[0]) == "metadata") {
        if (Status status = skip_metadata(); !status) return status;
        continue;
      }
      const auto tuples = words.size() == 4 ? scan::parse_number<uint64_t>(words[2]) : std::nullopt;
      if (!tuples) return bad_header(kFormat, "array not understood", *next);
      if (Status status = add(*next, words[0], words[1], words[3], *tuples); !status) return status;
      ++i;
    }
    return {};
  }

  /// Notes an array whose numbers begin here, and passes over them. Arrays of the whole file are only passed over.
  Status add(std::string_view line, std::string_view name, std::string_view components, std::string_view type_name,
             uint64_t tuples) {
    const auto count = scan::parse_number<uint64_t>(components);
    const Result<ScalarType> type = parse_type(type_name);
    if (!count || *count == 0) return bad_header(kFormat, "no number of components", line);
    if (!type) return fail(type.error());
    LegacyArray array{{std::string(name), *count, of_cells_, false}, *type, 0, lines_.offset()};
    array.values = stream::saturating(*count, tuples, 0);
    if (Status status = skip_numbers(array.values, *type); !status) return status;
    if (in_data_ && tuples == tuples_) grid_.arrays.push_back(std::move(array));
    return {};
  }

  Status skip_numbers(uint64_t values, ScalarType type) {
    size_t offset = lines_.offset();
    if (grid_.binary) {
      const uint64_t bytes = stream::saturating(values, scan::size_of(type), 0);
      if (bytes > text_.size() - offset) return truncated();
      offset += bytes;
    } else {
      scan::Tokens tokens(text_.substr(offset));
      for (uint64_t i = 0; i < values; ++i) {
        if (tokens.next().empty()) return truncated();
      }
      offset = text_.size() - tokens.rest().size();
    }
    lines_ = HeaderLines(text_, offset);
    return {};
  }

  static tl::unexpected<Error> truncated() {
    return fail(ErrorKind::kInvalidInput, "truncated: the VTK file ends within its numbers");
  }

  std::string_view text_;
  HeaderLines lines_;
  LegacyGrid grid_;
  bool has_dataset_ = false;
  bool in_data_ = false;
  bool of_cells_ = false;
  uint64_t tuples_ = 0;
};

Result<GridHeader> describe(const LegacyGrid& grid, const LegacyArray& array) {
  GridHeader header;
  header.format = kFormat;
  header.name = scan::printable(array.facts.name);
  header.type = array.type;
  const Result<SampleKind> kind = kind_of(array.facts);
  if (!kind) return fail(kind.error());
  header.kind = *kind;
  place_samples(grid.points, affine(glm::dmat3(1.0), grid.spacing, grid.origin), array.facts.of_cells, header);
  if (Status status = check_header(header); !status) return fail(std::move(status.error()));
  if (header.samples() * header.components() != array.values) {
    return fail(ErrorKind::kInvalidInput, "VTK: the array " + header.name + " does not have a value for each sample");
  }
  return header;
}

}  // namespace

Result<StoredGrid> parse_vtk_legacy(const GridFile& file) {
  Result<LegacyGrid> grid = LegacyParser(file.text()).parse();
  if (!grid) return fail(std::move(grid.error()));
  std::vector<VtkArray> facts;
  for (const LegacyArray& array : grid->arrays) facts.push_back(array.facts);
  const Result<size_t> chosen = choose_array(facts, file.array);
  if (!chosen) return fail(chosen.error());
  const LegacyArray& array = grid->arrays[*chosen];
  Result<GridHeader> header = describe(*grid, array);
  if (!header) return fail(std::move(header.error()));
  StoredSamples samples;
  samples.packing = grid->binary ? Packing::kRaw : Packing::kText;
  samples.type = header->type;
  samples.bytes = header->samples() * header->sample_bytes();
  samples.offset = array.offset;
  samples.file = file.file;
  StoredGrid stored;
  stored.header = std::move(*header);
  stored.swapped = grid->binary && std::endian::native == std::endian::little;
  stored.open = [samples = std::move(samples)] { return open_samples(samples); };
  return stored;
}

}  // namespace surfcast::grid
