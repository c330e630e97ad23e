#include "cmd/selection_flags.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "protocol/parse.h"

namespace surfcast::cmd {
namespace {

constexpr double kAnywhere = std::numeric_limits<double>::infinity();

/// Numbers between commas; none if one of them is no number.
std::vector<double> numbers_of(std::string_view text) {
  const auto commas = static_cast<size_t>(std::count(text.begin(), text.end(), ','));
  return protocol::parse_doubles(text, commas + 1).value_or(std::vector<double>());
}

/// Two corners, with or without heights.
geometry::Box box_of(const std::string& text) {
  const std::vector<double> numbers = numbers_of(text);
  geometry::Box box;
  if (numbers.size() == 4) {
    box.include(glm::dvec3(numbers[0], numbers[1], -kAnywhere));
    box.include(glm::dvec3(numbers[2], numbers[3], kAnywhere));
  } else if (numbers.size() == 6) {
    box.include(glm::dvec3(numbers[0], numbers[1], numbers[2]));
    box.include(glm::dvec3(numbers[3], numbers[4], numbers[5]));
  } else {
    throw CLI::ValidationError("--bounds", "needs 4 or 6 numbers");
  }
  return box;
}

/// Its width and the corners of its line; behind an @ its heights.
geometry::Corridor corridor_of(const std::string& text) {
  const size_t at = text.find('@');
  const std::vector<double> numbers = numbers_of(text.substr(0, at));
  if (numbers.size() < 5 || numbers.size() % 2 == 0 || numbers[0] < 0)
    throw CLI::ValidationError("--corridor", "needs a width and at least two corners");
  geometry::Corridor corridor;
  corridor.half_width = numbers[0] / 2;
  for (size_t i = 1; i < numbers.size(); i += 2) corridor.line.emplace_back(numbers[i], numbers[i + 1]);
  if (at == std::string::npos) return corridor;
  const std::vector<double> heights = numbers_of(text.substr(at + 1));
  if (heights.size() != 2) throw CLI::ValidationError("--corridor", "needs two heights behind the @");
  corridor.low = std::min(heights[0], heights[1]);
  corridor.high = std::max(heights[0], heights[1]);
  return corridor;
}

void add_zone_flags(CLI::App& command, geometry::Zone& zone) {
  command
      .add_option_function<std::vector<std::string>>(
          "--bounds",
          [&zone](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) zone.boxes.push_back(box_of(text));
          },
          "Read only points in a box, two opposite corners in the coordinates of the scan: X,Y,X,Y or X,Y,Z,X,Y,Z. "
          "May be given several times: points in any of the boxes")
      ->type_name("X,Y[,Z],X,Y[,Z]")
      ->allow_extra_args(false);
  command
      .add_option_function<std::vector<std::string>>(
          "--corridor",
          [&zone](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) zone.corridors.push_back(corridor_of(text));
          },
          "Read only points along a line, seen from above, in a corridor of this width: WIDTH,X,Y,X,Y and further "
          "corners, with @LOW,HIGH between these heights only. May be given several times")
      ->type_name("WIDTH,X,Y,X,Y...")
      ->allow_extra_args(false);
}

}  // namespace

void add_selection_flags(CLI::App& command, scan::Selection& selection) {
  add_zone_flags(command, selection.zone);
  command
      .add_option_function<std::vector<int>>(
          "--classes",
          [&selection](const std::vector<int>& classes) { selection.classes.assign(classes.begin(), classes.end()); },
          "Read only points of these classes, like 2,6")
      ->delimiter(',')
      ->check(CLI::Range(0, 255));
  command.add_option("--every", selection.every, "Read only every N-th point of each piece in which a scan is read")
      ->check(CLI::PositiveNumber);
}

}  // namespace surfcast::cmd
