#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <utility>

#include "scan/column_names.h"
#include "scan/readers.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

/// Bytes of text of one piece.
constexpr size_t kPieceBytes = size_t{1} << 23;

/// More columns than any scan has. The limit bounds the memory that a malicious line can request.
constexpr size_t kMaxColumns = 1024;

struct Format {
  bool comma_separates = true;
  bool counted = false;
  size_t columns = 0;
};

bool separates(char c, const Format& format) {
  return is_space(c) || c == ';' || (c == ',' && format.comma_separates);
}

/// Returns the next line from `at` on without its line ending. Moves `at` to the line after it.
std::string_view next_line(std::string_view text, size_t& at) {
  const size_t end = std::min(text.find('\n', at), text.size());
  const std::string_view line = text.substr(at, end - at);
  at = std::min(end + 1, text.size());
  return line;
}

std::vector<std::string_view> split(std::string_view line, const Format& format) {
  std::vector<std::string_view> words;
  for (size_t at = 0; at < line.size() && words.size() <= kMaxColumns;) {
    size_t end = at;
    while (end < line.size() && !separates(line[end], format)) ++end;
    if (end > at) words.push_back(line.substr(at, end - at));
    at = end + 1;
  }
  return words;
}

/// The line without leading white space.
std::string_view trim_left(std::string_view line) {
  const size_t first = std::min(line.find_first_not_of(" \t\r"), line.size());
  return line.substr(first);
}

bool is_comment(std::string_view trimmed) {
  return trimmed.starts_with('#') || trimmed.starts_with("//");
}

bool all_numbers(const std::vector<std::string_view>& words) {
  return std::all_of(words.begin(), words.end(),
                     [](std::string_view w) { return parse_number<double>(w).has_value(); });
}

// ---- prologue

/// The number format, the position of the first row, and the contents of the lines before it.
struct Prologue {
  Format format;
  uint64_t count = 0;  ///< rows stated by the file, if `counted`
  std::vector<std::string> names;
  size_t rows_offset = 0;
};

std::vector<std::string> names_in(std::string_view line, const Format& format) {
  std::vector<std::string> names;
  for (std::string_view word : split(line, format)) {
    while (word.starts_with('"') || word.starts_with('#') || word.starts_with('/')) word.remove_prefix(1);
    while (word.ends_with('"')) word.remove_suffix(1);
    if (!word.empty()) names.push_back(printable(word));
  }
  return names;
}

bool names_coordinates(const std::vector<std::string>& names) {
  return std::all_of(std::begin("xyz"), std::end("xyz") - 1, [&names](char axis) {
    return std::any_of(names.begin(), names.end(),
                       [axis](const std::string& n) { return canonical_attribute_name(n) == std::string(1, axis); });
  });
}

/// The number of rows of a PTS file, if the line is one.
std::optional<uint64_t> row_count(const std::vector<std::string_view>& words) {
  return words.size() == 1 ? parse_number<uint64_t>(words[0]) : std::nullopt;
}

/// Processes a header line or the first row. True if it was the first row.
Result<bool> take_line(std::string_view line, std::string_view& header, Prologue& prologue) {
  prologue.format.comma_separates = line.find(';') == std::string_view::npos;
  const std::vector<std::string_view> words = split(line, prologue.format);
  if (const auto count = row_count(words); count && !prologue.format.counted) {
    prologue.format.counted = true;
    prologue.count = *count;
    return false;
  }
  if (all_numbers(words)) {
    prologue.format.columns = words.size();
    return true;
  }
  if (!header.empty()) return fail(ErrorKind::kInvalidInput, "not a table of numbers: " + printable(line));
  if (!names_coordinates(names_in(line, prologue.format))) {
    return fail(ErrorKind::kInvalidInput, "text header does not name x, y and z: " + printable(line));
  }
  header = line;
  return false;
}

Status check_columns(const Prologue& prologue, std::string_view header) {
  const size_t columns = prologue.format.columns;
  if (columns < 3) return fail(ErrorKind::kInvalidInput, "text rows have fewer than three numbers");
  if (columns > kMaxColumns) return fail(ErrorKind::kInvalidInput, "text rows have too many numbers");
  if (!header.empty() && prologue.names.size() != columns) {
    return fail(ErrorKind::kInvalidInput, "text header names " + std::to_string(prologue.names.size()) +
                                              " columns, the first row has " + std::to_string(columns));
  }
  return {};
}

Result<Prologue> read_prologue(std::string_view text) {
  Prologue prologue;
  std::string_view comment;
  std::string_view header;
  for (size_t at = 0; at < text.size();) {
    prologue.rows_offset = at;
    const std::string_view line = trim_left(next_line(text, at));
    if (is_comment(line)) comment = line;
    if (line.empty() || is_comment(line)) continue;
    const Result<bool> is_row = take_line(line, header, prologue);
    if (!is_row) return fail(is_row);
    if (!*is_row) continue;
    prologue.names = names_in(header.empty() ? comment : header, prologue.format);
    if (Status status = check_columns(prologue, header); !status) return fail(status);
    // The comment was no header.
    if (prologue.names.size() != prologue.format.columns || !names_coordinates(prologue.names)) prologue.names.clear();
    return prologue;
  }
  return fail(ErrorKind::kInvalidInput, "has no points");
}

// ---- rows

/// The rows of one piece.
struct TextPiece {
  std::vector<double> values;
  uint64_t announced = 0;     ///< rows stated by count lines in this piece
  const char* bad = nullptr;  ///< the first line that is not a row
};

/// Appends the numbers of one line and returns how many there were. None if one word is not a number.
std::optional<size_t> append_row(std::string_view line, const Format& format, std::vector<double>& values) {
  const char* at = line.data();
  const char* const end = at + line.size();
  size_t count = 0;
  while (true) {
    while (at != end && separates(*at, format)) ++at;
    if (at == end) return count;
    double value = 0;
    auto [next, code] = std::from_chars(at, end, value);
    if (code != std::errc() || (next != end && !separates(*next, format))) {
      next = std::find_if(at, end, [&format](char c) { return separates(c, format); });
      const std::optional<double> unusual = parse_number<double>({at, static_cast<size_t>(next - at)});
      if (!unusual) return std::nullopt;
      value = *unusual;
    }
    if (++count > format.columns) return std::nullopt;
    values.push_back(value);
    at = next;
  }
}

TextPiece read_rows(std::string_view text, const Format& format) {
  TextPiece piece;
  for (size_t at = 0; at < text.size();) {
    const std::string_view line = next_line(text, at);
    const std::string_view trimmed = trim_left(line);
    if (trimmed.empty() || is_comment(trimmed)) continue;
    const std::optional<size_t> count = append_row(line, format, piece.values);
    if (count == format.columns) continue;
    const double last = count == 1U ? piece.values.back() : -1.0;
    if (!format.counted || !(last >= 0 && last < 0x1p63)) {
      piece.bad = line.data();
      break;
    }
    piece.announced += static_cast<uint64_t>(last);
    piece.values.pop_back();
  }
  return piece;
}

/// Parts of about `kPieceBytes` that end at line ends.
std::vector<std::string_view> split_into_pieces(std::string_view text) {
  std::vector<std::string_view> pieces;
  while (!text.empty()) {
    const size_t end =
        text.size() <= kPieceBytes ? text.size() : std::min(text.find('\n', kPieceBytes), text.size() - 1) + 1;
    pieces.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return pieces;
}

tl::unexpected<Error> bad_line(std::string_view text, const char* bad) {
  const auto number = 1 + std::count(text.data(), bad, '\n');
  size_t at = static_cast<size_t>(bad - text.data());
  return fail(ErrorKind::kInvalidInput,
              "line " + std::to_string(number) + " does not fit the first row: " + printable(next_line(text, at)));
}

class TextRows : public RowSource {
 public:
  TextRows(std::string_view text, const Prologue& prologue)
      : text_(text),
        format_(prologue.format),
        columns_(prologue.format.columns, {"", ScalarType::kFloat64, false}),
        pieces_(split_into_pieces(text.substr(prologue.rows_offset))) {
    for (size_t i = 0; i < prologue.names.size(); ++i) columns_[i].name = prologue.names[i];
    traits_.from_text = true;
    traits_.counted = prologue.format.counted;
    traits_.announced = prologue.count;
  }

  [[nodiscard]] const RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return pieces_.size(); }
  [[nodiscard]] Result<PointTable> read(size_t piece) const override {
    TextPiece rows = read_rows(pieces_[piece], format_);
    if (rows.bad != nullptr) return bad_line(text_, rows.bad);
    PointTable table;
    table.rows = rows.values.size() / columns_.size();
    table.announced = rows.announced;
    const auto* first = reinterpret_cast<const std::byte*>(rows.values.data());
    const size_t stride = columns_.size() * sizeof(double);
    for (size_t i = 0; i < columns_.size(); ++i) {
      table.columns.push_back({ScalarType::kFloat64, first + i * sizeof(double), stride, false});
    }
    table.storage.emplace_back(std::move(rows.values));
    return table;
  }

 private:
  std::string_view text_;
  Format format_;
  RowTraits traits_;
  std::vector<ColumnInfo> columns_;
  std::vector<std::string_view> pieces_;
};

std::string_view without_mark(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

}  // namespace

bool begins_like_text_table(std::string_view text) {
  return read_prologue(text).has_value();
}

std::vector<std::string> text_column_names(std::string_view text) {
  Result<Prologue> prologue = read_prologue(without_mark(text));
  return prologue ? std::move(prologue->names) : std::vector<std::string>();
}

Result<std::unique_ptr<RowSource>> text_rows(std::span<const std::byte> bytes) {
  const std::string_view text = without_mark(as_text(bytes));
  const Result<Prologue> prologue = read_prologue(text);
  if (!prologue) return fail(prologue);
  return std::make_unique<TextRows>(text, *prologue);
}

}  // namespace surfcast::scan
