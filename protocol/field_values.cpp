#include "protocol/field_values.h"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <string>

#include "protocol/parse.h"

namespace surfcast::protocol {
namespace {

constexpr uint32_t kLargestColorPart = 255;

tl::unexpected<Error> wrong(const PictureField& field, const std::string& what) {
  return fail(ErrorKind::kInvalidInput, std::string(field.name) + ": " + what);
}

/// What numbers of a range are, in words.
std::string range_text(const NumberRange& range, bool above) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  if (std::isfinite(range.most)) {
    text << "must lie between " << range.least << " and " << range.most;
  } else {
    text << "must be a finite number" << (range.unit.empty() ? "" : " of ") << range.unit;
    text << (above ? " above " : ", at least ") << range.least;
  }
  return text.str();
}

bool lies_in(const NumberRange& range, bool above, double number) {
  return std::isfinite(number) && number <= range.most && (above ? number > range.least : number >= range.least);
}

}  // namespace

std::optional<double> parse_number(const NumberRange& range, std::string_view text) {
  const std::optional<double> value = parse_double(text);
  return value && lies_in(range, range.above, *value) ? value : std::nullopt;
}

std::optional<bool> parse_switch(std::string_view text) {
  if (text != "on" && text != "off") return std::nullopt;
  return text == "on";
}

bool parse_color(std::string_view text, wire::Color& color) {
  const auto values = parse_unsigneds(text, 3);
  if (!values) return false;
  color.set_red((*values)[0]);
  color.set_green((*values)[1]);
  color.set_blue((*values)[2]);
  return color.red() <= kLargestColorPart && color.green() <= kLargestColorPart && color.blue() <= kLargestColorPart;
}

Status check_choice(const PictureField& field, int number) {
  const auto count = 1 + std::count(field.form.begin(), field.form.end(), '|');
  return number >= 0 && number < count ? Status() : wrong(field, "unknown");
}

Status check_number(const PictureField& field, double number, bool stated) {
  if (!stated && number == 0) return {};
  const bool above = field.value.range.above && stated;
  return lies_in(field.value.range, above, number) ? Status() : wrong(field, range_text(field.value.range, above));
}

Status check_color(const PictureField& field, const wire::Color& color) {
  if (color.red() <= kLargestColorPart && color.green() <= kLargestColorPart && color.blue() <= kLargestColorPart) {
    return {};
  }
  return wrong(field, "each part must be at most 255");
}

}  // namespace surfcast::protocol
