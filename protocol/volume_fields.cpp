#include "protocol/volume_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "protocol/parse.h"

namespace surfcast::protocol {
namespace {

/// A part of a colour, 0 to 255.
bool set_part(double value, uint32_t& part) {
  if (!(value >= 0 && value <= 255) || value != std::floor(value)) return false;
  part = static_cast<uint32_t>(value);
  return true;
}

/// A colour from three successive numbers, the first at `first`.
bool set_color(const std::vector<double>& values, size_t first, wire::Color& color) {
  std::array<uint32_t, 3> parts{};
  for (size_t i = 0; i < parts.size(); ++i) {
    if (!set_part(values[first + i], parts[i])) return false;
  }
  color.set_red(parts[0]);
  color.set_green(parts[1]);
  color.set_blue(parts[2]);
  return true;
}

bool set_point(wire::TransferPoint& point, std::string_view text) {
  const auto values = parse_doubles(text, 5);
  if (!values || !set_color(*values, 1, *point.mutable_color())) return false;
  point.set_value((*values)[0]);
  point.set_opacity((*values)[4]);
  return true;
}

/// Sets a list from a text with ';' between its members.
template <typename Message, typename Setter>
bool set_list(google::protobuf::RepeatedPtrField<Message>& list, std::string_view text, const Setter& set) {
  google::protobuf::RepeatedPtrField<Message> members;
  while (true) {
    const size_t end = text.find(';');
    if (!set(*members.Add(), text.substr(0, end))) return false;
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
  list.Swap(&members);
  return true;
}

bool set_preset(wire::TransferFunction& transfer, std::string_view text) {
  const size_t comma = text.find(',');
  const auto preset = parse_transfer_preset(text.substr(0, comma));
  if (!preset) return false;
  transfer.set_preset(*preset);
  if (comma == std::string_view::npos) return true;
  const auto ends = parse_doubles(text.substr(comma + 1), 2);
  if (!ends || !((*ends)[0] < (*ends)[1])) return false;
  transfer.set_first((*ends)[0]);
  transfer.set_last((*ends)[1]);
  return true;
}

/// VALUE, VALUE,R,G,B or VALUE,R,G,B,OPACITY.
bool set_iso_surface(wire::IsoSurface& surface, std::string_view text) {
  const auto commas = static_cast<size_t>(std::count(text.begin(), text.end(), ','));
  const auto values = parse_doubles(text, commas + 1);
  if (!values || (commas != 0 && commas != 3 && commas != 4)) return false;
  if (commas > 0 && !set_color(*values, 1, *surface.mutable_color())) return false;
  surface.set_value((*values)[0]);
  if (commas == 4) surface.set_opacity((*values)[4]);
  return commas < 4 || is_share(surface.opacity());
}

bool set_slice_by_index(wire::Slice& slice, std::string_view text) {
  constexpr std::string_view kAxes = "ijk";
  const size_t axis = text.size() > 2 && text[1] == ',' ? kAxes.find(text[0]) : std::string_view::npos;
  if (axis == std::string_view::npos) return false;
  const auto index = parse_double(text.substr(2));
  if (!index) return false;
  slice.set_axis(static_cast<wire::GridAxis>(wire::GRID_AXIS_I + static_cast<int>(axis)));
  slice.set_index(*index);
  return true;
}

bool set_slice(wire::Slice& slice, std::string_view text) {
  if (set_slice_by_index(slice, text)) return true;
  const auto values = parse_doubles(text, 6);
  if (!values) return false;
  const auto set = [&values](wire::Vector3& vector, size_t first) {
    vector.set_x((*values)[first]);
    vector.set_y((*values)[first + 1]);
    vector.set_z((*values)[first + 2]);
  };
  set(*slice.mutable_point(), 0);
  set(*slice.mutable_normal(), 3);
  return (*values)[3] != 0 || (*values)[4] != 0 || (*values)[5] != 0;
}

}  // namespace

std::optional<wire::TransferPreset> parse_transfer_preset(std::string_view name) {
  constexpr std::array<std::string_view, 5> kNames{"gray", "ct-bone", "ct-soft", "mr", "auto"};
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<wire::TransferPreset>(found - kNames.begin());
}

bool set_transfer(wire::DrawPicture& picture, std::string_view text) {
  wire::TransferFunction transfer;
  if (!set_preset(transfer, text) && !set_list(*transfer.mutable_points(), text, set_point)) return false;
  *picture.mutable_transfer() = std::move(transfer);
  return true;
}

bool set_iso_surfaces(wire::DrawPicture& picture, std::string_view text) {
  return set_list(*picture.mutable_iso_surfaces(), text, set_iso_surface);
}

bool set_slices(wire::DrawPicture& picture, std::string_view text) {
  return set_list(*picture.mutable_slices(), text, set_slice);
}

}  // namespace surfcast::protocol
