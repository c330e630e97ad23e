#include "scan/ptx_reader.h"

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scan/narrow_scalars.h"
#include "scan/point_table.h"
#include "scan/text_tokens.h"

namespace surfcast {
namespace {

/// Takes row vectors from the scanner to the world: p' = (p, 1) M. The fourth column of M is not used.
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

/// Columns, rows, the scanner's position and axes (which the matrix repeats), the matrix.
Result<Station> read_station(Tokens& tokens) {
  constexpr const char* kWhere = "a PTX header";
  const Result<uint64_t> columns = next_count(tokens);
  if (!columns) return fail(columns.error());
  const Result<uint64_t> rows = next_count(tokens);
  if (!rows) return fail(rows.error());
  Station station{*columns * *rows, {}};
  for (int i = 0; i < 12; ++i) {
    if (const Result<double> number = next_number(tokens, kWhere); !number) return fail(number.error());
  }
  for (double& entry : station.matrix) {
    const Result<double> number = next_number(tokens, kWhere);
    if (!number) return fail(number.error());
    entry = *number;
  }
  return station;
}

/// Words in the line that follows.
size_t words_in_next_line(Tokens tokens) {
  const std::string_view rest = tokens.rest();
  const size_t first = rest.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return 0;
  Tokens line(rest.substr(first, rest.find('\n', first) - first));
  size_t words = 0;
  while (!line.next().empty()) ++words;
  return words;
}

/// Rows of 4 or 7 numbers: x y z intensity and perhaps r g b.
struct Rows {
  size_t columns = 0;
  std::vector<double> values;
};

Status read_points(Tokens& tokens, const Station& station, Rows& rows) {
  if (station.points == 0) return {};
  const size_t columns = words_in_next_line(tokens);
  if (columns != 4 && columns != 7) {
    return fail(ErrorKind::kInvalidInput, "PTX points have neither 4 nor 7 numbers");
  }
  if (rows.columns != 0 && rows.columns != columns) {
    return fail(ErrorKind::kInvalidInput, "PTX stations differ in the numbers of each point");
  }
  rows.columns = columns;
  for (uint64_t i = 0; i < station.points; ++i) {
    const size_t first = rows.values.size();
    for (size_t column = 0; column < columns; ++column) {
      const Result<double> number = next_number(tokens, "the PTX points");
      if (!number) return fail(number.error());
      rows.values.push_back(*number);
    }
    double* xyz = &rows.values[first];
    glm::dvec3 p(xyz[0], xyz[1], xyz[2]);
    p = p == glm::dvec3(0) ? glm::dvec3(std::numeric_limits<double>::quiet_NaN()) : transform(station.matrix, p);
    for (int axis = 0; axis < 3; ++axis) xyz[axis] = p[axis];
  }
  return {};
}

PointTable table_of(Rows rows) {
  constexpr std::array kNames = {"x", "y", "z", "intensity", "red", "green", "blue"};
  PointTable table;
  table.rows = rows.columns == 0 ? 0 : rows.values.size() / rows.columns;
  const auto* first = reinterpret_cast<const std::byte*>(rows.values.data());
  for (size_t i = 0; i < rows.columns; ++i) {
    table.columns.push_back(
        {kNames.at(i), ScalarType::kFloat64, first + i * sizeof(double), rows.columns * sizeof(double), false});
  }
  table.storage.emplace_back(std::move(rows.values));
  return table;
}

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

Result<ScanPoints> read_ptx(std::span<const std::byte> bytes) {
  Tokens tokens(as_text(bytes));
  Rows rows;
  std::vector<Station> stations;
  do {
    const Result<Station> station = read_station(tokens);
    if (!station) return fail(station.error());
    if (Status status = read_points(tokens, *station, rows); !status) return fail(status.error());
    stations.push_back(*station);
  } while (!Tokens(tokens).next().empty());
  if (rows.values.empty()) return fail(ErrorKind::kInvalidInput, "has no points");
  Result<ScanPoints> points = points_from_table(table_of(std::move(rows)));
  if (!points) return points;
  for (ScalarAttribute& scalar : points->scalars) scalar.values = narrow_scalars(std::move(scalar.values));
  if (stations.size() == 1) points->sensor = transform(stations[0].matrix, glm::dvec3(0));
  return points;
}

}  // namespace surfcast
