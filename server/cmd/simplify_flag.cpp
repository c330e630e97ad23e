#include "cmd/simplify_flag.h"

#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

namespace surfcast::cmd {
namespace {

std::optional<double> positive(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value > 0) || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::optional<simplify::ErrorBound> parse_bound(std::string_view text) {
  const size_t comma = text.find(',');
  const std::optional<double> degrees = positive(text.substr(0, comma));
  if (!degrees || *degrees > 45) return std::nullopt;
  if (comma == std::string_view::npos) return simplify::ErrorBound{*degrees, std::nullopt};
  const std::optional<double> height = positive(text.substr(comma + 1));
  if (!height) return std::nullopt;
  return simplify::ErrorBound{*degrees, height};
}

}  // namespace

void add_simplify_flag(CLI::App& command, std::optional<simplify::ErrorBound>& bound) {
  command
      .add_option_function<std::string>(
          "--simplify", [&bound](const std::string& text) { bound = parse_bound(text); },
          "Replace the points of smooth surfaces by fewer surfels with curvature. DEGREES[,HEIGHT]: nine in ten "
          "normals "
          "are within DEGREES, all points within HEIGHT of the surface, in units of the scan (default: twice the angle "
          "times the distance)")
      ->type_name("DEGREES[,HEIGHT]")
      ->check([](const std::string& text) {
        return parse_bound(text) ? std::string() : "not degrees up to 45 and a height: " + text;
      });
}

}  // namespace surfcast::cmd
