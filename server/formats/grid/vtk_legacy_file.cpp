#include "grid/vtk_legacy_file.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "base/ascii_text.h"
#include "grid/header_text.h"
#include "scan/text_tokens.h"
#include "stream/byte_stream.h"

namespace surfcast::grid {
namespace {

using scan::ScalarType;

Result<ScalarType> parse_legacy_type(std::string_view text) {
  static constexpr std::pair<std::string_view, ScalarType> kTypes[] = {
      {"unsigned_char", ScalarType::kUint8}, {"char", ScalarType::kInt8},
      {"signed_char", ScalarType::kInt8},    {"unsigned_short", ScalarType::kUint16},
      {"short", ScalarType::kInt16},         {"unsigned_int", ScalarType::kUint32},
      {"int", ScalarType::kInt32},           {"unsigned_long", ScalarType::kUint64},
      {"long", ScalarType::kInt64},          {"vtktypeuint64", ScalarType::kUint64},
      {"vtktypeint64", ScalarType::kInt64},  {"vtkidtype", ScalarType::kInt32},
      {"float", ScalarType::kFloat32},       {"double", ScalarType::kFloat64},
  };
  const std::string name = to_lower(text);
  for (const auto& [known, type] : kTypes) {
    if (known == name) return type;
  }
  return bad_header(kVtk, "type of numbers not supported", text);
}

/// VTK writes what is not a printable character of a name as "%20".
std::string decoded_name(std::string_view text) {
  std::string name;
  for (size_t i = 0; i < text.size(); ++i) {
    unsigned char byte = 0;
    const char* const digits = text.data() + i + 1;
    if (text[i] == '%' && text.size() - i > 2 && std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      name += static_cast<char>(byte);
      i += 2;
    } else {
      name += text[i];
    }
  }
  return name;
}

/// Goes through the file section by section. The numbers of an array are passed over, not read.
class LegacyParser {
 public:
  LegacyParser(std::string_view text, std::span<const std::string_view> datasets)
      : text_(text), lines_(text), datasets_(datasets) {}

  Result<LegacyFile> parse() {
    lines_.next();  // "# vtk DataFile Version"
    lines_.next();  // a title
    const std::string encoding = to_lower(next_filled_line());
    if (encoding != "ascii" && encoding != "binary") return bad_header(kVtk, "neither ASCII nor BINARY", encoding);
    file_.binary = encoding == "binary";
    while (const std::optional<std::string_view> line = lines_.next()) {
      if (Status status = parse_line(*line); !status) return fail(status);
    }
    if (!has_dataset_) return fail(ErrorKind::kInvalidInput, "truncated: VTK file without a data set");
    return std::move(file_);
  }

 private:
  using Words = std::vector<std::string_view>;

  static std::string_view word(const Words& words, size_t i) {
    return i < words.size() ? words[i] : std::string_view();
  }

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
    const Words words = words_of(line);
    if (words.empty()) return {};
    const std::string keyword = to_lower(words[0]);
    if (keyword == "dataset") return check_dataset(line, words);
    if (keyword == "dimensions") return take_dimensions(line, words);
    if (keyword == "spacing" || keyword == "aspect_ratio") return take_vector(line, words, file_.spacing);
    if (keyword == "origin") return take_vector(line, words, file_.origin);
    if (keyword == "point_data" || keyword == "cell_data") return begin_data(line, words, keyword == "cell_data");
    if (keyword == "metadata") return skip_metadata();
    if (keyword == "points") return take_points(line, words);
    if (is_cells(keyword)) return skip_cells(line, words, keyword);
    return parse_section(line, words, keyword);
  }

  static bool is_cells(const std::string& keyword) {
    static constexpr std::array kCells{"cells",    "cell_types",      "vertices", "lines",
                                       "polygons", "triangle_strips", "offsets",  "connectivity"};
    return std::find(kCells.begin(), kCells.end(), keyword) != kCells.end();
  }

  Status take_points(std::string_view line, const Words& words) {
    const auto count = scan::parse_number<uint64_t>(word(words, 1));
    const Result<ScalarType> type = parse_legacy_type(word(words, 2));
    if (!count) return bad_header(kVtk, "no number of points", line);
    if (!type) return fail(type);
    file_.points = {*type, stream::saturating(*count, 3, 0), lines_.offset()};
    return skip_numbers(file_.points.count, *type);
  }

  /// "CELLS n size", or in files of version 5 with arrays OFFSETS and CONNECTIVITY of their own.
  Status skip_cells(std::string_view line, const Words& words, const std::string& keyword) {
    const auto first = scan::parse_number<uint64_t>(word(words, 1));
    const auto second = scan::parse_number<uint64_t>(word(words, 2));
    if (keyword == "offsets" || keyword == "connectivity") {
      const Result<ScalarType> type = parse_legacy_type(word(words, 1));
      if (!type) return fail(type);
      return skip_numbers(keyword == "offsets" ? offsets_ : connectivity_, *type);
    }
    if (!first) return bad_header(kVtk, "no number of cells", line);
    if (keyword == "cell_types") return skip_numbers(*first, ScalarType::kInt32);
    if (!second) return bad_header(kVtk, "no size of cells", line);
    HeaderLines ahead = lines_;
    const Words next = words_of(ahead.next().value_or(""));
    const bool by_offsets = !next.empty() && to_lower(next[0]) == "offsets";
    // A point of POLYDATA as a vertex is no cell to anyone.
    if (keyword != "vertices") file_.cells += by_offsets && *first > 0 ? *first - 1 : *first;
    if (by_offsets) {
      offsets_ = *first;
      connectivity_ = *second;
      return {};
    }
    return skip_numbers(*second, ScalarType::kInt32);
  }

  Status check_dataset(std::string_view line, const Words& words) {
    has_dataset_ = true;
    if (words.size() > 1 && std::ranges::find(datasets_, to_lower(words[1])) != datasets_.end()) return {};
    return fail(ErrorKind::kUnsupported, "VTK: not a regular grid: " + scan::printable(line));
  }

  Status take_dimensions(std::string_view line, const Words& words) {
    const auto counts = counts_of(line.substr(line.find(words[0]) + words[0].size()));
    if (!counts || counts->size() != 3) return bad_header(kVtk, "wrong dimensions", line);
    std::copy_n(counts->begin(), 3, file_.dimensions.begin());
    return {};
  }

  static Status take_vector(std::string_view line, const Words& words, glm::dvec3& into) {
    const auto numbers = numbers_of(line.substr(line.find(words[0]) + words[0].size()));
    if (!numbers || numbers->size() != 3) return bad_header(kVtk, "not three numbers", line);
    into = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
    return {};
  }

  Status begin_data(std::string_view line, const Words& words, bool of_cells) {
    const auto count = words.size() > 1 ? scan::parse_number<uint64_t>(words[1]) : std::nullopt;
    if (!count) return bad_header(kVtk, "no number of samples", line);
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

  Status parse_section(std::string_view line, const Words& words, const std::string& keyword) {
    if (keyword == "field") return parse_fields(line, word(words, 2));
    if (keyword == "lookup_table") return skip_lookup_table(line, word(words, 2));
    if (keyword == "color_scalars") {
      return add(line, word(words, 1), word(words, 2), file_.binary ? "unsigned_char" : "float", tuples_,
                 VtkRole::kColors);
    }
    if (keyword == "scalars") {
      if (Status status = skip_table_name(); !status) return status;
      return add(line, word(words, 1), word(words, 3).empty() ? "1" : word(words, 3), word(words, 2), tuples_,
                 VtkRole::kScalars);
    }
    if (keyword == "texture_coordinates") return add(line, word(words, 1), word(words, 2), word(words, 3), tuples_);
    const auto add_typed = [&](std::string_view components, VtkRole role) {
      return add(line, word(words, 1), components, word(words, 2), tuples_, role);
    };
    if (keyword == "vectors") return add_typed("3", VtkRole::kNone);
    if (keyword == "normals") return add_typed("3", VtkRole::kNormals);
    if (keyword == "tensors") return add_typed("9", VtkRole::kTensors);
    if (keyword == "tensors6") return add_typed("6", VtkRole::kTensors);
    if (keyword == "global_ids" || keyword == "pedigree_ids") return add_typed("1", VtkRole::kNone);
    return bad_header(kVtk, "line not understood", line);
  }

  /// The line "LOOKUP_TABLE name" between SCALARS and the numbers, which old writers leave out.
  Status skip_table_name() {
    HeaderLines ahead = lines_;
    const std::optional<std::string_view> line = ahead.next();
    if (line && to_lower(scan::Tokens(*line).next()) == "lookup_table") lines_ = ahead;
    return {};
  }

  /// Four numbers a colour; bytes in binary files.
  Status skip_lookup_table(std::string_view line, std::string_view size) {
    const auto count = scan::parse_number<uint64_t>(size);
    if (!count) return bad_header(kVtk, "no size of a lookup table", line);
    return skip_numbers(stream::saturating(*count, 4, 0), file_.binary ? ScalarType::kUint8 : ScalarType::kFloat32);
  }

  /// Arrays with lines "name components tuples type".
  Status parse_fields(std::string_view line, std::string_view count_text) {
    const auto count = scan::parse_number<uint64_t>(count_text);
    if (!count) return bad_header(kVtk, "no number of arrays", line);
    for (uint64_t i = 0; i < *count;) {
      const std::optional<std::string_view> next = lines_.next();
      if (!next) return fail(ErrorKind::kInvalidInput, "truncated: the VTK file ends within its arrays");
      const Words words = words_of(*next);
      if (words.empty()) continue;
      if (to_lower(words[0]) == "metadata") {
        if (Status status = skip_metadata(); !status) return status;
        continue;
      }
      const auto tuples = words.size() == 4 ? scan::parse_number<uint64_t>(words[2]) : std::nullopt;
      if (!tuples) return bad_header(kVtk, "array not understood", *next);
      if (Status status = add(*next, words[0], words[1], words[3], *tuples); !status) return status;
      ++i;
    }
    return {};
  }

  /// Notes an array whose numbers begin here, and passes over them. Arrays of the whole file are only passed over.
  Status add(std::string_view line, std::string_view name, std::string_view components, std::string_view type_name,
             uint64_t tuples, VtkRole role = VtkRole::kNone) {
    const auto count = scan::parse_number<uint64_t>(components);
    const Result<ScalarType> type = parse_legacy_type(type_name);
    if (!count || *count == 0) return bad_header(kVtk, "no number of components", line);
    if (!type) return fail(type);
    const VtkNumbers numbers{*type, stream::saturating(*count, tuples, 0), lines_.offset()};
    if (Status status = skip_numbers(numbers.count, *type); !status) return status;
    if (!in_data_ || tuples != tuples_) return {};
    file_.arrays.push_back({{decoded_name(name), *count, of_cells_, role, false}, tuples, numbers});
    return {};
  }

  Status skip_numbers(uint64_t values, ScalarType type) {
    size_t offset = lines_.offset();
    if (file_.binary) {
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
  std::span<const std::string_view> datasets_;
  LegacyFile file_;
  bool has_dataset_ = false;
  bool in_data_ = false;
  bool of_cells_ = false;
  uint64_t tuples_ = 0;
  uint64_t offsets_ = 0;  ///< of the cells that follow
  uint64_t connectivity_ = 0;
};

}  // namespace

bool is_vtk_legacy_point_set(std::string_view text) {
  if (!text.starts_with("# vtk DataFile")) return false;
  HeaderLines lines(text.substr(0, 4096));
  while (const std::optional<std::string_view> line = lines.next()) {
    const std::vector<std::string_view> words = words_of(*line);
    if (words.size() < 2 || to_lower(words[0]) != "dataset") continue;
    return std::ranges::find(kVtkPointSets, to_lower(words[1])) != kVtkPointSets.end();
  }
  return false;
}

Result<LegacyFile> scan_vtk_legacy(std::string_view text, std::span<const std::string_view> datasets) {
  return LegacyParser(text, datasets).parse();
}

}  // namespace surfcast::grid
