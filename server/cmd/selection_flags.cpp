#include "cmd/selection_flags.h"

#include <limits>
#include <string>
#include <vector>

namespace surfcast::cmd {
namespace {

/// Two corners, with or without heights.
geometry::Box box_of(const std::vector<double>& numbers) {
  constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  geometry::Box box;
  if (numbers.size() == 4) {
    box.include(glm::dvec3(numbers[0], numbers[1], -kAnywhere));
    box.include(glm::dvec3(numbers[2], numbers[3], kAnywhere));
  } else {
    box.include(glm::dvec3(numbers[0], numbers[1], numbers[2]));
    box.include(glm::dvec3(numbers[3], numbers[4], numbers[5]));
  }
  return box;
}

void add_bounds_flag(CLI::App& command, scan::Selection& selection) {
  command
      .add_option_function<std::vector<double>>(
          "--bounds",
          [&selection](const std::vector<double>& numbers) {
            if (numbers.size() != 4 && numbers.size() != 6)
              throw CLI::ValidationError("--bounds", "needs 4 or 6 numbers");
            selection.bounds = box_of(numbers);
          },
          "Read only points in a box, two opposite corners in the coordinates of the scan: X,Y,X,Y or X,Y,Z,X,Y,Z")
      ->delimiter(',')
      ->expected(1, 6);
}

}  // namespace

void add_selection_flags(CLI::App& command, scan::Selection& selection) {
  add_bounds_flag(command, selection);
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
