#include "protocol/profile_query.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/ascii_text.h"
#include "protocol/parse.h"
#include "protocol/url_query.h"
#include "protocol/validate.h"

namespace surfcast::protocol {
namespace {

tl::unexpected<Error> wanted(std::string_view name, std::string_view form, std::string_view text) {
  return fail(ErrorKind::kInvalidInput,
              std::string(name) + ": expected " + std::string(form) + ", got '" + std::string(text) + "'");
}

bool set_line(wire::GetProfile& profile, std::string_view text) {
  profile.clear_line();
  for (bool more = true; more;) {
    const size_t end = text.find(';');
    const auto values = parse_doubles(text.substr(0, end), 3);
    if (!values) return false;
    wire::Vector3* point = profile.add_line();
    point->set_x((*values)[0]);
    point->set_y((*values)[1]);
    point->set_z((*values)[2]);
    more = end != std::string_view::npos;
    if (more) text.remove_prefix(end + 1);
  }
  return profile.line_size() >= 2 && profile.line_size() <= kMaxProfileLine;
}

bool set_width(wire::GetProfile& profile, std::string_view text) {
  const auto value = parse_double(text);
  if (!value || !(*value > 0)) return false;
  profile.set_width(*value);
  return true;
}

bool set_max_points(wire::GetProfile& profile, std::string_view text) {
  const auto value = parse_unsigned(text);
  if (!value || *value == 0) return false;
  profile.set_max_points(*value);
  return true;
}

}  // namespace

Status set_profile_field(wire::GetProfile& profile, std::string_view name, std::string_view text) {
  if (name == "line") {
    return set_line(profile, text) ? Status() : wanted(name, "X,Y,Z;X,Y,Z;... of 2 to 1024 points", text);
  }
  if (name == "width") return set_width(profile, text) ? Status() : wanted(name, "a number above 0", text);
  if (name == "max_points") return set_max_points(profile, text) ? Status() : wanted(name, "a count above 0", text);
  return fail(ErrorKind::kNotFound, "there is no parameter '" + std::string(name) + "'");
}

Status check_profile(const wire::GetProfile& profile) {
  if (Status status = check_model_name(profile.model()); !status) return status;
  if (profile.line_size() < 2 || profile.line_size() > kMaxProfileLine) {
    return fail(ErrorKind::kInvalidInput, "line: expected 2 to 1024 points");
  }
  for (const wire::Vector3& point : profile.line()) {
    if (!std::isfinite(point.x()) || !std::isfinite(point.y()) || !std::isfinite(point.z())) {
      return fail(ErrorKind::kInvalidInput, "line: coordinates must be finite numbers");
    }
  }
  if (!(profile.width() > 0) || !std::isfinite(profile.width())) {
    return fail(ErrorKind::kInvalidInput, "width: must be a finite number above 0");
  }
  return {};
}

Status check_profile_answer(const wire::Profile& profile) {
  const int count = profile.x_size();
  bool equal = profile.y_size() == count && profile.z_size() == count && profile.along_size() == count &&
               profile.across_size() == count;
  if (profile.color_bits() > 0) {
    equal &= profile.red_size() == count && profile.green_size() == count && profile.blue_size() == count;
  }
  for (const wire::AttributeColumn& attribute : profile.attributes()) equal &= attribute.values_size() == count;
  const auto finite = [](const auto& values) {
    return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
  };
  if (equal && finite(profile.x()) && finite(profile.y()) && finite(profile.z())) return {};
  return fail(ErrorKind::kInvalidInput, "the server sent a profile that is none");
}

Result<ProfileFormat> parse_profile_format(std::string_view text) {
  const std::string lower = to_lower(text);
  if (lower == "csv") return ProfileFormat::kCsv;
  if (lower == "las") return ProfileFormat::kLas;
  return fail(ErrorKind::kUnsupported, "'" + std::string(text) + "' is not a format of profiles: csv, las");
}

Result<ProfileQuery> parse_profile_query(std::string_view model, std::string_view query) {
  ProfileQuery result;
  result.profile.set_model(std::string(model));
  Status status = for_each_parameter(query, [&result](const std::string& name, const std::string& text) -> Status {
    if (name != "format") return set_profile_field(result.profile, name, text);
    const Result<ProfileFormat> format = parse_profile_format(text);
    if (!format) return fail(ErrorKind::kInvalidInput, format.error().message);
    result.format = *format;
    return {};
  });
  if (status) status = check_profile(result.profile);
  if (!status) return fail(status);
  return result;
}

}  // namespace surfcast::protocol
