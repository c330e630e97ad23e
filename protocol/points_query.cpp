#include "protocol/points_query.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/ascii_text.h"
#include "base/invalid_input.h"
#include "protocol/parse.h"
#include "protocol/url_query.h"
#include "protocol/validate.h"

namespace surfcast::protocol {
namespace {

constexpr std::array<std::pair<std::string_view, wire::PointFormat>, 5> kPointFormats = {
    {{"las", wire::POINT_FORMAT_LAS},
     {"laz", wire::POINT_FORMAT_LAZ},
     {"ply", wire::POINT_FORMAT_PLY},
     {"csv", wire::POINT_FORMAT_CSV},
     {"npy", wire::POINT_FORMAT_NPY}}};

tl::unexpected<Error> not_of_form(std::string_view name, std::string_view form, std::string_view text) {
  return fail(ErrorKind::kInvalidInput,
              std::string(name) + ": expected " + std::string(form) + ", got '" + std::string(text) + "'");
}

/// Numbers between commas; none if one of them is no number.
std::vector<double> numbers_between_commas(std::string_view text) {
  const auto commas = static_cast<size_t>(std::count(text.begin(), text.end(), ','));
  return parse_doubles(text, commas + 1).value_or(std::vector<double>());
}

/// Calls `add` with what stands between semicolons, until it returns false.
template <typename Add>
bool for_each_part(std::string_view text, const Add& add) {
  for (;;) {
    const size_t end = text.find(';');
    if (!add(text.substr(0, end))) return false;
    if (end == std::string_view::npos) return true;
    text.remove_prefix(end + 1);
  }
}

bool add_box(wire::GetPoints& points, std::string_view text) {
  const std::vector<double> numbers = numbers_between_commas(text);
  if (numbers.size() != 6) return false;
  wire::Box* box = points.add_boxes();
  box->mutable_min()->set_x(numbers[0]);
  box->mutable_min()->set_y(numbers[1]);
  box->mutable_min()->set_z(numbers[2]);
  box->mutable_max()->set_x(numbers[3]);
  box->mutable_max()->set_y(numbers[4]);
  box->mutable_max()->set_z(numbers[5]);
  return true;
}

bool add_corridor(wire::GetPoints& points, std::string_view text) {
  const size_t at = text.find('@');
  const std::vector<double> numbers = numbers_between_commas(text.substr(0, at));
  if (numbers.size() < 5 || numbers.size() % 2 == 0) return false;
  wire::Corridor* corridor = points.add_corridors();
  corridor->set_width(numbers[0]);
  for (size_t i = 1; i < numbers.size(); ++i) corridor->add_line(numbers[i]);
  if (at == std::string_view::npos) return true;
  const std::vector<double> heights = numbers_between_commas(text.substr(at + 1));
  if (heights.size() != 2) return false;
  corridor->set_low(heights[0]);
  corridor->set_high(heights[1]);
  return true;
}

bool set_region_classes(wire::GetPoints& points, std::string_view text) {
  points.clear_classes();
  for (const double code : numbers_between_commas(text)) {
    if (!(code >= 0 && code <= kMaxClassCode && code == std::floor(code))) return false;
    points.add_classes(static_cast<uint32_t>(code));
  }
  return points.classes_size() > 0;
}

Status set_number(std::string_view name, std::string_view text, const std::function<void(uint32_t)>& set) {
  const auto value = parse_unsigned(text);
  if (!value || *value == 0) return not_of_form(name, "a count above 0", text);
  set(*value);
  return {};
}

Status set_switch(std::string_view name, std::string_view text, const std::function<void(bool)>& set) {
  if (text != "0" && text != "1") return not_of_form(name, "0 or 1", text);
  set(text == "1");
  return {};
}

bool is_finite(const wire::Vector3& v) {
  return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}

Status check_region_box(const wire::Box& box) {
  if (!is_finite(box.min()) || !is_finite(box.max())) return invalid_input("box: coordinates must be finite numbers");
  const bool ordered =
      box.min().x() <= box.max().x() && box.min().y() <= box.max().y() && box.min().z() <= box.max().z();
  return ordered ? Status() : invalid_input("box: the lower corner must come first");
}

Status check_corridor(const wire::Corridor& corridor) {
  if (corridor.line_size() < 4 || corridor.line_size() % 2 != 0)
    return invalid_input("corridor: expected at least two corners with two coordinates each");
  if (!std::all_of(corridor.line().begin(), corridor.line().end(), [](double value) { return std::isfinite(value); }))
    return invalid_input("corridor: coordinates must be finite numbers");
  if (!(corridor.width() > 0) || !std::isfinite(corridor.width()))
    return invalid_input("corridor: its width must be a finite number above 0");
  if (std::isnan(corridor.low()) || std::isnan(corridor.high()))
    return invalid_input("corridor: its heights must be numbers");
  const bool ordered = !corridor.has_low() || !corridor.has_high() || corridor.low() <= corridor.high();
  return ordered ? Status() : invalid_input("corridor: the lower height must come first");
}

}  // namespace

Status set_points_field(wire::GetPoints& points, std::string_view name, std::string_view text) {
  if (name == "box" || name == "bounds") {
    const bool set = for_each_part(text, [&points](std::string_view part) { return add_box(points, part); });
    return set ? Status() : not_of_form(name, "X,Y,Z,X,Y,Z of two corners, several with ; between them", text);
  }
  if (name == "corridor") {
    const bool set = for_each_part(text, [&points](std::string_view part) { return add_corridor(points, part); });
    return set ? Status() : not_of_form(name, "WIDTH,X,Y,X,Y... with or without @LOW,HIGH", text);
  }
  if (name == "classes") {
    return set_region_classes(points, text) ? Status() : not_of_form(name, "a list of codes from 0 to 255", text);
  }
  if (name == "every") return set_number(name, text, [&points](uint32_t value) { points.set_every(value); });
  if (name == "max_points") return set_number(name, text, [&points](uint32_t value) { points.set_max_points(value); });
  if (name == "count") return set_switch(name, text, [&points](bool on) { points.set_only_count(on); });
  if (name == "normals") return set_switch(name, text, [&points](bool on) { points.set_normals(on); });
  if (name == "coordinates") {
    if (text != "source" && text != "world") return not_of_form(name, "source or world", text);
    points.set_world_coordinates(text == "world");
    return {};
  }
  if (name != "format") return fail(ErrorKind::kNotFound, "there is no parameter '" + std::string(name) + "'");
  const Result<wire::PointFormat> format = parse_point_format(text);
  if (!format) return invalid_input(format.error().message);
  points.set_format(*format);
  return {};
}

Status check_points(const wire::GetPoints& points) {
  if (Status status = check_model_name(points.model()); !status) return status;
  if (points.boxes_size() > kMaxRegionBoxes) return invalid_input("box: at most 64 are possible");
  if (points.corridors_size() > kMaxCorridors) return invalid_input("corridor: at most 64 are possible");
  for (const wire::Box& box : points.boxes()) {
    if (Status status = check_region_box(box); !status) return status;
  }
  int corners = 0;
  for (const wire::Corridor& corridor : points.corridors()) {
    if (Status status = check_corridor(corridor); !status) return status;
    corners += corridor.line_size() / 2;
  }
  if (corners > kMaxCorridorCorners) return invalid_input("corridor: at most 1024 corners are possible");
  for (const uint32_t code : points.classes()) {
    if (code > kMaxClassCode) return invalid_input("classes: codes must be at most 255");
  }
  if (!wire::PointFormat_IsValid(points.format())) return invalid_input("format: unknown");
  return {};
}

Result<wire::PointFormat> parse_point_format(std::string_view text) {
  const std::string lower = to_lower(text);
  std::string names;
  for (const auto& [name, format] : kPointFormats) {
    if (lower == name) return format;
    names += (names.empty() ? "" : ", ") + std::string(name);
  }
  return fail(ErrorKind::kUnsupported, "'" + std::string(text) + "' is not a format of points: " + names);
}

std::string_view name_of(wire::PointFormat format) {
  for (const auto& [name, value] : kPointFormats) {
    if (value == format) return name;
  }
  return {};
}

Result<wire::GetPoints> parse_points_query(std::string_view model, std::string_view query) {
  wire::GetPoints points;
  points.set_model(std::string(model));
  points.set_format(wire::POINT_FORMAT_CSV);
  Status status = for_each_parameter(query, [&points](const std::string& name, const std::string& text) {
    return set_points_field(points, name, text);
  });
  if (status) status = check_points(points);
  if (!status) return fail(status);
  return points;
}

}  // namespace surfcast::protocol
