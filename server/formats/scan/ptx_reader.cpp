#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scan/point_table.h"
#include "scan/readers.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

/// Transforms row vectors from the scanner's frame to the world: p' = (p, 1) M. The fourth column of M is ignored.
using Matrix = std::array<double, 16>;

glm::dvec3 transform(const Matrix& m, const glm::dvec3& p) {
  return glm::dvec3(m[0], m[1], m[2]) * p.x + glm::dvec3(m[4], m[5], m[6]) * p.y + glm::dvec3(m[8], m[9], m[10]) * p.z +
         glm::dvec3(m[12], m[13], m[14]);
}

struct Station {
  uint64_t points = 0;
  Matrix matrix{};
};

tl::unexpected<Error> malformed(std::string_view word, const char* where) {
  if (word.empty()) return fail(ErrorKind::kInvalidInput, std::string("truncated: the file ends within ") + where);
  return fail(ErrorKind::kInvalidInput, std::string("not a number in ") + where + ": " + printable(word));
}

Result<double> next_number(Tokens& tokens, const char* where) {
  const std::string_view word = tokens.next();
  const std::optional<double> number = parse_number<double>(word);
  if (!number) return malformed(word, where);
  return *number;
}

Result<uint64_t> next_count(Tokens& tokens) {
  const std::string_view word = tokens.next();
  const std::optional<uint32_t> count = parse_number<uint32_t>(word);
  if (!count) return malformed(word, "a PTX header");
  return *count;
}

/// Reads columns, rows, the scanner's position and axes (which the matrix repeats), and the matrix.
Result<Station> read_station(Tokens& tokens) {
  constexpr const char* kWhere = "a PTX header";
  const Result<uint64_t> columns = next_count(tokens);
  if (!columns) return fail(columns);
  const Result<uint64_t> rows = next_count(tokens);
  if (!rows) return fail(rows);
  Station station{*columns * *rows, {}};
  for (int i = 0; i < 12; ++i) {
    if (const Result<double> number = next_number(tokens, kWhere); !number) return fail(number);
  }
  for (double& entry : station.matrix) {
    const Result<double> number = next_number(tokens, kWhere);
    if (!number) return fail(number);
    entry = *number;
  }
  return station;
}

/// Number of words in the next line.
size_t words_in_next_line(Tokens tokens) {
  const std::string_view rest = tokens.rest();
  const size_t first = rest.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return 0;
  Tokens line(rest.substr(first, rest.find('\n', first) - first));
  size_t words = 0;
  while (!line.next().empty()) ++words;
  return words;
}

/// Consecutive points of one station that are read together.
struct Piece {
  Tokens start;
  uint64_t rows = 0;
  Matrix matrix{};
};

/// The pieces of all stations, found in a first pass over the points.
struct Layout {
  size_t columns = 0;  ///< numbers of each point: 4 (x y z intensity) or 7 (with r g b)
  std::vector<Piece> pieces;
  std::vector<Matrix> stations;
};

Status pass_points(Tokens& tokens, const Station& station, Layout& layout) {
  if (station.points == 0) return {};
  const size_t columns = words_in_next_line(tokens);
  if (columns != 4 && columns != 7) {
    return fail(ErrorKind::kInvalidInput, "PTX points have neither 4 nor 7 numbers");
  }
  if (layout.columns != 0 && layout.columns != columns) {
    return fail(ErrorKind::kInvalidInput, "PTX stations differ in the numbers of each point");
  }
  layout.columns = columns;
  for (uint64_t i = 0; i < station.points; ++i) {
    if (i % kPieceRows == 0)
      layout.pieces.push_back({tokens, std::min(kPieceRows, station.points - i), station.matrix});
    for (size_t column = 0; column < columns; ++column) {
      if (tokens.next().empty()) return malformed("", "the PTX points");
    }
  }
  return {};
}

Result<Layout> find_layout(Tokens tokens) {
  Layout layout;
  do {
    const Result<Station> station = read_station(tokens);
    if (!station) return fail(station);
    if (Status status = pass_points(tokens, *station, layout); !status) return fail(status);
    layout.stations.push_back(station->matrix);
  } while (!Tokens(tokens).next().empty());
  if (layout.pieces.empty()) return fail(ErrorKind::kInvalidInput, "has no points");
  return layout;
}

/// Transforms a point to the world. A ray without an echo becomes NaN.
void place_point(double* xyz, const Matrix& matrix) {
  glm::dvec3 p(xyz[0], xyz[1], xyz[2]);
  p = p == glm::dvec3(0) ? glm::dvec3(std::numeric_limits<double>::quiet_NaN()) : transform(matrix, p);
  for (int axis = 0; axis < 3; ++axis) xyz[axis] = p[axis];
}

class PtxRows : public RowSource {
 public:
  explicit PtxRows(Layout layout) : layout_(std::move(layout)) {
    constexpr std::array kNames = {"x", "y", "z", "intensity", "red", "green", "blue"};
    for (size_t i = 0; i < layout_.columns; ++i) columns_.push_back({kNames.at(i), ScalarType::kFloat64, false});
    traits_.from_text = true;
    if (layout_.stations.size() == 1) traits_.sensor = transform(layout_.stations[0], glm::dvec3(0));
  }

  [[nodiscard]] const RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return layout_.pieces.size(); }
  [[nodiscard]] Result<PointTable> read(size_t index) const override {
    Piece piece = layout_.pieces[index];
    std::vector<double> values(piece.rows * layout_.columns);
    for (double& value : values) {
      const Result<double> number = next_number(piece.start, "the PTX points");
      if (!number) return fail(number);
      value = *number;
    }
    for (size_t row = 0; row < piece.rows; ++row) place_point(&values[row * layout_.columns], piece.matrix);
    PointTable table;
    table.rows = piece.rows;
    const auto* first = reinterpret_cast<const std::byte*>(values.data());
    for (size_t i = 0; i < layout_.columns; ++i) {
      table.columns.push_back(
          {ScalarType::kFloat64, first + i * sizeof(double), layout_.columns * sizeof(double), false});
    }
    table.storage.emplace_back(std::move(values));
    return table;
  }

 private:
  Layout layout_;
  RowTraits traits_;
  std::vector<ColumnInfo> columns_;
};

}  // namespace

bool looks_like_ptx(std::string_view text) {
  size_t at = 0;
  for (int i = 0; i < 2; ++i) {
    const size_t end = text.find('\n', at);
    if (end == std::string_view::npos) return false;
    Tokens line(text.substr(at, end - at));
    if (!parse_number<uint32_t>(line.next()) || !line.next().empty()) return false;
    at = end + 1;
  }
  return true;
}

Result<std::unique_ptr<RowSource>> ptx_rows(std::span<const std::byte> bytes) {
  Result<Layout> layout = find_layout(Tokens(as_text(bytes)));
  if (!layout) return fail(layout);
  return std::make_unique<PtxRows>(std::move(*layout));
}

}  // namespace surfcast::scan
