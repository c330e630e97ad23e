#include "protocol/display_fields.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "protocol/parse.h"
#include "protocol/validate.h"

namespace surfcast::protocol {
namespace {

using Numbers = std::vector<double>;

/// The attributes that every ellipsoid has, or one by name.
bool set_attribute(wire::DrawPicture& picture, std::string_view text) {
  constexpr std::string_view kByName = "attribute:";
  const bool by_name = text.starts_with(kByName);
  if (by_name) text.remove_prefix(kByName.size());
  if (text.empty() || text.size() > kMaxAttributeBytes) return false;
  if (!by_name && text != "fa" && text != "mode" && text != "md") return false;
  picture.mutable_coloring()->set_source(wire::COLOR_SOURCE_ATTRIBUTE);
  picture.mutable_coloring()->set_attribute(std::string(text));
  return true;
}

/// The parts of a text between separators; an empty text has one part.
std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (size_t end = text.find(separator); end != std::string_view::npos; end = text.find(separator)) {
    parts.push_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  parts.push_back(text);
  return parts;
}

std::optional<double> parse_share(std::string_view text) {
  const std::optional<double> value = parse_double(text);
  return value && *value >= 0 && *value <= 1 ? value : std::nullopt;
}

std::optional<wire::ClipBox> parse_clip_box(std::string_view text, bool inverted) {
  const std::optional<Numbers> values = parse_doubles(text, 6);
  if (!values) return std::nullopt;
  const auto set = [&values](wire::Vector3* corner, size_t first) {
    corner->set_x((*values)[first]);
    corner->set_y((*values)[first + 1]);
    corner->set_z((*values)[first + 2]);
  };
  const auto below = [&values](size_t axis) { return (*values)[axis] <= (*values)[axis + 3]; };
  if (!below(0) || !below(1) || !below(2)) return std::nullopt;
  wire::ClipBox clip;
  set(clip.mutable_box()->mutable_min(), 0);
  set(clip.mutable_box()->mutable_max(), 3);
  clip.set_inverted(inverted);
  return clip;
}

/// Replaces the boxes that have this value of `inverted`; keeps the others.
bool set_clip_boxes(wire::DrawPicture& picture, std::string_view text, bool inverted) {
  std::vector<wire::ClipBox> boxes;
  for (const wire::ClipBox& box : picture.clip_boxes()) {
    if (box.inverted() != inverted) boxes.push_back(box);
  }
  for (const std::string_view part : split(text, ';')) {
    const std::optional<wire::ClipBox> box = parse_clip_box(part, inverted);
    if (!box) return false;
    boxes.push_back(*box);
  }
  picture.mutable_clip_boxes()->Assign(boxes.begin(), boxes.end());
  return true;
}

}  // namespace

bool set_color_source(wire::DrawPicture& picture, std::string_view text) {
  constexpr std::array<std::string_view, 7> kNames{"rgb",    "intensity", "elevation", "classification",
                                                   "normal", "direction", "dec"};
  const auto found = std::find(kNames.begin(), kNames.end(), text);
  if (found == kNames.end()) return set_attribute(picture, text);
  picture.mutable_coloring()->set_source(static_cast<wire::ColorSource>(found - kNames.begin()));
  return true;
}

bool set_color_range(wire::DrawPicture& picture, std::string_view text) {
  const std::optional<Numbers> values = parse_doubles(text, 2);
  if (!values || !((*values)[0] < (*values)[1])) return false;
  picture.mutable_coloring()->set_first((*values)[0]);
  picture.mutable_coloring()->set_last((*values)[1]);
  return true;
}

bool set_hidden_classes(wire::DrawPicture& picture, std::string_view text) {
  std::vector<uint32_t> codes;
  for (const std::string_view part : split(text, ',')) {
    const std::optional<uint32_t> code = parse_unsigned(part);
    if (!code || *code > kMaxClassCode) return false;
    codes.push_back(*code);
  }
  picture.mutable_hidden_classes()->Assign(codes.begin(), codes.end());
  return true;
}

bool set_hidden_models(wire::DrawPicture& picture, std::string_view text) {
  google::protobuf::RepeatedPtrField<std::string> models;
  for (const std::string_view name : split(text, ',')) {
    if (name.empty()) return false;  // check_picture has the other limits
    *models.Add() = std::string(name);
  }
  picture.mutable_hidden_models()->Swap(&models);
  return true;
}

bool set_class_opacities(wire::DrawPicture& picture, std::string_view text) {
  google::protobuf::RepeatedPtrField<wire::ClassOpacity> classes;
  for (const std::string_view part : split(text, ',')) {
    const size_t equals = part.find('=');
    if (equals == std::string_view::npos) return false;
    const std::optional<uint32_t> code = parse_unsigned(part.substr(0, equals));
    const std::optional<double> opacity = parse_share(part.substr(equals + 1));
    if (!code || *code > kMaxClassCode || !opacity) return false;
    wire::ClassOpacity* added = classes.Add();
    added->set_code(*code);
    added->set_opacity(*opacity);
  }
  picture.mutable_class_opacities()->Swap(&classes);
  return true;
}

bool set_boxes_to_show(wire::DrawPicture& picture, std::string_view text) {
  return set_clip_boxes(picture, text, false);
}

bool set_boxes_to_hide(wire::DrawPicture& picture, std::string_view text) {
  return set_clip_boxes(picture, text, true);
}

bool set_eye_dome(wire::DrawPicture& picture, std::string_view text) {
  const size_t comma = text.find(',');
  const std::optional<double> strength = parse_double(text.substr(0, comma));
  const std::optional<double> radius =
      comma == std::string_view::npos ? std::optional(0.0) : parse_double(text.substr(comma + 1));
  if (!strength || !(*strength >= 0 && *strength <= kMaxEyeDomeStrength)) return false;
  if (!radius || !(*radius >= 0 && *radius <= kMaxEyeDomeRadius)) return false;
  picture.mutable_eye_dome()->set_strength(*strength);
  picture.mutable_eye_dome()->set_radius(*radius);
  return true;
}

}  // namespace surfcast::protocol
