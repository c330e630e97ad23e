#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/ascii_text.h"
#include "scan/point_table.h"
#include "scan/readers.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

struct GridHeader {
  uint64_t columns = 0;
  uint64_t rows = 0;
  glm::dvec2 first{0};  ///< the middle of the south-western cell
  glm::dvec2 step{0};   ///< of neighbouring cells
  std::optional<double> no_value;

  /// The middle of a cell; cells are counted from the north-western one, row by row.
  [[nodiscard]] glm::dvec2 middle(uint64_t cell) const {
    const uint64_t from_north = cell / columns;
    return first + step * glm::dvec2(cell % columns, rows - 1 - from_north);
  }
  [[nodiscard]] bool has_value(double height) const { return std::isfinite(height) && height != no_value; }
};

tl::unexpected<Error> bad_grid(const std::string& what) {
  return fail(ErrorKind::kInvalidInput, "ASCII grid: " + what);
}

/// The values of a header by the places of their names in kHeaderNames.
constexpr std::array<std::string_view, 10> kHeaderNames = {
    "ncols", "nrows", "xllcorner", "xllcenter", "yllcorner", "yllcenter", "cellsize", "dx", "dy", "nodata_value"};
enum Name { kColumns, kRows, kLeft, kLeftMiddle, kBottom, kBottomMiddle, kStep, kStepX, kStepY, kNoValue };
using HeaderValues = std::array<std::optional<double>, kHeaderNames.size()>;

/// Reads names and their numbers up to the first word that is no name.
Result<HeaderValues> read_values(Tokens& tokens) {
  HeaderValues values;
  while (true) {
    Tokens ahead = tokens;
    const std::string word = to_lower(ahead.next());
    const auto* const name = std::find(kHeaderNames.begin(), kHeaderNames.end(), word);
    if (name == kHeaderNames.end()) return values;
    const std::string_view number = ahead.next();
    const std::optional<double> value = parse_number<double>(number);
    if (!value) return bad_grid(word + " is not a number: " + printable(number));
    values.at(static_cast<size_t>(name - kHeaderNames.begin())) = *value;
    tokens = ahead;
  }
}

/// A number of cells. Their product with another one fits into 64 bits.
Result<uint64_t> count_of(const HeaderValues& values, Name name) {
  const std::optional<double>& value = values.at(name);
  if (!value) return bad_grid(std::string(kHeaderNames.at(name)) + " is missing");
  if (!(*value >= 1 && *value <= double{UINT32_MAX} && std::floor(*value) == *value)) {
    return bad_grid(std::string(kHeaderNames.at(name)) + " is not a number of cells");
  }
  return static_cast<uint64_t>(*value);
}

Result<double> step_of(const HeaderValues& values, Name name) {
  const std::optional<double>& value = values.at(name) ? values.at(name) : values.at(kStep);
  if (!value) return bad_grid("cellsize is missing");
  if (!(*value > 0 && std::isfinite(*value))) return bad_grid("the size of a cell is not positive");
  return *value;
}

/// The middle of the first cell along an axis, from that of the cell or from its outer edge.
Result<double> first_of(const HeaderValues& values, Name corner, Name middle, double step) {
  const std::optional<double> first =
      values.at(middle) ? values.at(middle)
                        : (values.at(corner) ? std::optional(*values.at(corner) + step / 2) : std::nullopt);
  if (!first) return bad_grid(std::string(kHeaderNames.at(corner)) + " is missing");
  if (!std::isfinite(*first)) return bad_grid(std::string(kHeaderNames.at(corner)) + " is not finite");
  return *first;
}

Result<GridHeader> read_header(Tokens& tokens) {
  const Result<HeaderValues> values = read_values(tokens);
  if (!values) return fail(values);
  const Result<uint64_t> columns = count_of(*values, kColumns);
  if (!columns) return fail(columns);
  const Result<uint64_t> rows = count_of(*values, kRows);
  if (!rows) return fail(rows);
  const Result<double> step_x = step_of(*values, kStepX);
  if (!step_x) return fail(step_x);
  const Result<double> step_y = step_of(*values, kStepY);
  if (!step_y) return fail(step_y);
  const Result<double> x = first_of(*values, kLeft, kLeftMiddle, *step_x);
  if (!x) return fail(x);
  const Result<double> y = first_of(*values, kBottom, kBottomMiddle, *step_y);
  if (!y) return fail(y);
  return GridHeader{*columns, *rows, {*x, *y}, {*step_x, *step_y}, values->at(kNoValue)};
}

Result<double> next_height(Tokens& tokens) {
  const std::string_view word = tokens.next();
  const std::optional<double> height = parse_number<double>(word);
  if (!height) return bad_grid("a cell is not a number: " + printable(word));
  return *height;
}

/// True if a cell has a value.
Result<bool> any_value(Tokens tokens, const GridHeader& header) {
  for (uint64_t i = 0; i < header.columns * header.rows; ++i) {
    const Result<double> height = next_height(tokens);
    if (!height) return fail(height);
    if (header.has_value(*height)) return true;
  }
  return false;
}

/// Consecutive cells that are read together.
struct CellRun {
  Tokens start;
  uint64_t first = 0;
  uint64_t cells = 0;
};

/// Finds where the runs begin, in a first pass over the cells.
Result<std::vector<CellRun>> find_runs(Tokens tokens, const GridHeader& header) {
  const uint64_t cells = header.columns * header.rows;
  std::vector<CellRun> runs;
  for (uint64_t i = 0; i < cells; ++i) {
    if (i % kPieceRows == 0) runs.push_back({tokens, i, std::min(kPieceRows, cells - i)});
    if (tokens.next().empty()) {
      return bad_grid("truncated: " + std::to_string(i) + " of " + std::to_string(cells) + " cells");
    }
  }
  if (!Tokens(tokens).next().empty()) return bad_grid("has more than " + std::to_string(cells) + " cells");
  return runs;
}

/// The text of a file beside a grid; empty if there is none.
std::string read_projection(const std::filesystem::path& path) {
  constexpr std::streamsize kMax = 1 << 16;  // more than the WKT of any system
  std::ifstream file(path, std::ios::binary);
  std::string text(kMax, '\0');
  file.read(text.data(), kMax);
  text.resize(static_cast<size_t>(file.gcount()));
  return text;
}

/// True for WKT, whose first word is followed by a bracket; older files have lines of names and values instead.
bool is_wkt(std::string_view text) {
  const size_t end = text.find_first_of("[( \t\r\n");
  return end != std::string_view::npos && (text[end] == '[' || text[end] == '(');
}

/// Takes the coordinate system from the file beside a grid.
void read_system(const std::filesystem::path& file, RowTraits& traits) {
  std::string text = read_projection(file);
  if (text.empty()) return;
  if (is_wkt(text)) {
    traits.crs = std::move(text);
  } else {
    traits.notes.push_back(file.filename().string() + " states no coordinate system as WKT and is ignored");
  }
}

class AsciiGridRows : public RowSource {
 public:
  AsciiGridRows(const GridHeader& header, std::vector<CellRun> runs, RowTraits traits)
      : header_(header), runs_(std::move(runs)), traits_(std::move(traits)) {
    for (const char* name : {"x", "y", "z"}) columns_.push_back({name, ScalarType::kFloat64, false});
  }

  [[nodiscard]] const RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return runs_.size(); }
  [[nodiscard]] Result<PointTable> read(size_t index) const override {
    CellRun run = runs_[index];
    std::vector<double> points;
    for (uint64_t i = 0; i < run.cells; ++i) {
      const Result<double> height = next_height(run.start);
      if (!height) return fail(height);
      if (!header_.has_value(*height)) continue;
      const glm::dvec2 middle = header_.middle(run.first + i);
      points.insert(points.end(), {middle.x, middle.y, *height});
    }
    return table_of(std::move(points));
  }

 private:
  static PointTable table_of(std::vector<double> points) {
    PointTable table;
    table.rows = points.size() / 3;
    const auto* first = reinterpret_cast<const std::byte*>(points.data());
    for (size_t axis = 0; axis < 3; ++axis) {
      table.columns.push_back({ScalarType::kFloat64, first + axis * sizeof(double), 3 * sizeof(double), false});
    }
    table.storage.emplace_back(std::move(points));
    return table;
  }

  GridHeader header_;
  std::vector<CellRun> runs_;
  RowTraits traits_;
  std::vector<ColumnInfo> columns_;
};

}  // namespace

bool looks_like_ascii_grid(std::string_view text) {
  Tokens tokens(text.substr(0, 256));
  return to_lower(tokens.next()) == kHeaderNames[kColumns] && parse_number<double>(tokens.next());
}

std::filesystem::path projection_file(const std::filesystem::path& grid) {
  std::filesystem::path file = grid;
  return file.replace_extension(".prj");
}

Result<std::unique_ptr<RowSource>> ascii_grid_rows(std::span<const std::byte> bytes,
                                                   const std::filesystem::path& path) {
  Tokens tokens(as_text(bytes));
  const Result<GridHeader> header = read_header(tokens);
  if (!header) return fail(header);
  Result<std::vector<CellRun>> runs = find_runs(tokens, *header);
  if (!runs) return fail(runs);
  const Result<bool> any = any_value(tokens, *header);
  if (!any) return fail(any);
  if (!*any) return fail(ErrorKind::kInvalidInput, "has no points");
  RowTraits traits;
  read_system(projection_file(path), traits);
  return std::make_unique<AsciiGridRows>(*header, std::move(*runs), std::move(traits));
}

}  // namespace surfcast::scan
