#include "cmd/iso_flag.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "protocol/parse.h"

namespace surfcast::cmd {
namespace {

/// As many numbers as there are commas and one more; none if one of them is no number.
std::vector<double> numbers_of(std::string_view text) {
  const auto commas = static_cast<size_t>(std::count(text.begin(), text.end(), ','));
  return protocol::parse_doubles(text, commas + 1).value_or(std::vector<double>());
}

bool is_code(double number) {
  return number >= 0 && number <= 255 && std::trunc(number) == number;
}

}  // namespace

Result<isosurface::IsoSurface> parse_iso_surface(std::string_view text) {
  const std::vector<double> numbers = numbers_of(text);
  const bool counted = numbers.size() == 1 || numbers.size() == 4 || numbers.size() == 5;
  const bool colored = numbers.size() > 1;
  if (!counted || (colored && !std::all_of(numbers.begin() + 1, numbers.begin() + 4, is_code))) {
    return fail(ErrorKind::kInvalidInput,
                "not VALUE or VALUE,R,G,B with a colour of integers from 0 to 255: " + std::string(text));
  }
  if (numbers.size() == 5 && numbers[4] != 1) {
    return fail(ErrorKind::kUnsupported, "surfaces of an opacity other than 1 are not supported: " + std::string(text));
  }
  isosurface::IsoSurface surface{numbers[0]};
  if (colored) surface.color = glm::u8vec3(numbers[1], numbers[2], numbers[3]);
  return surface;
}

CLI::Option* add_iso_flag(CLI::App& command, std::vector<isosurface::IsoSurface>& surfaces) {
  const auto append = [&surfaces](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      const Result<isosurface::IsoSurface> surface = parse_iso_surface(text);
      if (!surface) throw CLI::ValidationError("--iso", surface.error().message);
      surfaces.push_back(*surface);
    }
  };
  return command
      .add_option_function<std::vector<std::string>>(
          "--iso", append,
          "Make of a volume the surface where it has this value: VALUE or VALUE,R,G,B (0 to 255; default light grey). "
          "May be given several times")
      ->type_name("VALUE[,R,G,B]")
      ->allow_extra_args(false);
}

}  // namespace surfcast::cmd
