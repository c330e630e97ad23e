#include "scan/text_table.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <utility>

#include <tbb/parallel_for.h>

#include "scan/attribute_names.h"
#include "scan/text_tokens.h"

namespace surfcast {
namespace {

/// Text that one task reads at a time.
constexpr size_t kChunkBytes = size_t{1} << 20;

/// More columns than any scan has; bounds what a line of a hostile file can ask for.
constexpr size_t kMostColumns = 1024;

struct Format {
  bool comma_separates = true;
  bool counted = false;
  size_t columns = 0;
};

bool separates(char c, const Format& format) {
  return is_space(c) || c == ';' || (c == ',' && format.comma_separates);
}

/// The next line from `at` on, without its end; moves `at` behind it.
std::string_view next_line(std::string_view text, size_t& at) {
  const size_t end = std::min(text.find('\n', at), text.size());
  const std::string_view line = text.substr(at, end - at);
  at = std::min(end + 1, text.size());
  return line;
}

std::vector<std::string_view> split(std::string_view line, const Format& format) {
  std::vector<std::string_view> words;
  for (size_t at = 0; at < line.size() && words.size() <= kMostColumns;) {
    size_t end = at;
    while (end < line.size() && !separates(line[end], format)) ++end;
    if (end > at) words.push_back(line.substr(at, end - at));
    at = end + 1;
  }
  return words;
}

/// Without the spaces before it.
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

// ---- what stands before the rows

/// How the rows are written, where they begin, and what is said before them.
struct Prologue {
  Format format;
  uint64_t count = 0;  ///< of rows, when the file is counted
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

/// Whether the line is the number of rows of a PTS file.
std::optional<uint64_t> row_count(const std::vector<std::string_view>& words) {
  return words.size() == 1 ? parse_number<uint64_t>(words[0]) : std::nullopt;
}

/// Takes a header line or the first row into account; whether it was the first row.
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
  if (columns > kMostColumns) return fail(ErrorKind::kInvalidInput, "text rows have too many numbers");
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
    if (!is_row) return fail(is_row.error());
    if (!*is_row) continue;
    prologue.names = names_in(header.empty() ? comment : header, prologue.format);
    if (Status status = check_columns(prologue, header); !status) return fail(status.error());
    // A comment that is no header.
    if (prologue.names.size() != prologue.format.columns || !names_coordinates(prologue.names)) prologue.names.clear();
    return prologue;
  }
  return fail(ErrorKind::kInvalidInput, "has no points");
}

// ---- rows

/// The rows of a part of the text.
struct Chunk {
  std::string_view text;
  std::vector<double> values;
  uint64_t counted_rows = 0;  ///< that count lines in this part announce
  const char* bad = nullptr;  ///< the first line that is no row
};

/// Appends the numbers of one line. Nothing when one of them is none, else how many there were.
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

void read_rows(const Format& format, Chunk& chunk) {
  for (size_t at = 0; at < chunk.text.size();) {
    const std::string_view line = next_line(chunk.text, at);
    const std::string_view trimmed = trim_left(line);
    if (trimmed.empty() || is_comment(trimmed)) continue;
    const std::optional<size_t> count = append_row(line, format, chunk.values);
    if (count == format.columns) continue;
    const double last = count == 1U ? chunk.values.back() : -1.0;
    if (!format.counted || !(last >= 0 && last < 0x1p63)) {
      chunk.bad = line.data();
      return;
    }
    chunk.counted_rows += static_cast<uint64_t>(last);
    chunk.values.pop_back();
  }
}

/// Parts of about `kChunkBytes` that end with a line.
std::vector<Chunk> split_into_chunks(std::string_view text) {
  std::vector<Chunk> chunks;
  while (!text.empty()) {
    const size_t end =
        text.size() <= kChunkBytes ? text.size() : std::min(text.find('\n', kChunkBytes), text.size() - 1) + 1;
    chunks.push_back({text.substr(0, std::min(end, text.size())), {}, 0, nullptr});
    text.remove_prefix(chunks.back().text.size());
  }
  return chunks;
}

tl::unexpected<Error> bad_line(std::string_view text, const char* bad) {
  const auto number = 1 + std::count(text.data(), bad, '\n');
  size_t at = static_cast<size_t>(bad - text.data());
  return fail(ErrorKind::kInvalidInput,
              "line " + std::to_string(number) + " does not fit the first row: " + printable(next_line(text, at)));
}

std::vector<double> join(std::vector<Chunk> chunks) {
  if (chunks.size() == 1) return std::move(chunks[0].values);
  size_t total = 0;
  for (const Chunk& chunk : chunks) total += chunk.values.size();
  std::vector<double> joined;
  joined.reserve(total);
  for (Chunk& chunk : chunks) {
    const std::vector<double> values = std::exchange(chunk.values, {});
    joined.insert(joined.end(), values.begin(), values.end());
  }
  return joined;
}

}  // namespace

bool begins_like_text_table(std::string_view text) {
  return read_prologue(text).has_value();
}

Result<TextTable> parse_text_table(std::string_view text) {
  Result<Prologue> prologue = read_prologue(text);
  if (!prologue) return fail(prologue.error());
  const Format& format = prologue->format;
  std::vector<Chunk> chunks = split_into_chunks(text.substr(prologue->rows_offset));
  tbb::parallel_for(size_t{0}, chunks.size(), [&](size_t i) { read_rows(format, chunks[i]); });
  uint64_t counted_rows = prologue->count;
  for (const Chunk& chunk : chunks) {
    if (chunk.bad != nullptr) return bad_line(text, chunk.bad);
    counted_rows += chunk.counted_rows;
  }
  TextTable table{format.columns, join(std::move(chunks)), std::move(prologue->names), format.counted};
  if (table.counted && table.rows() < counted_rows) {
    return fail(ErrorKind::kInvalidInput, "truncated: the file states " + std::to_string(counted_rows) +
                                              " points and holds " + std::to_string(table.rows()));
  }
  return table;
}

}  // namespace surfcast
