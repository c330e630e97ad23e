#include "protocol/volume_fields.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "protocol/parse.h"

namespace surfcast::protocol {
namespace {

/// A part of a colour, 0 to 255.
bool set_part(double value, uint32_t& part) {
  if (!(value >= 0 && value <= 255) || value != std::floor(value)) return false;
  part = static_cast<uint32_t>(value);
  return true;
}

bool add_point(wire::TransferFunction& transfer, std::string_view text) {
  const auto values = parse_doubles(text, 5);
  std::array<uint32_t, 3> color{};
  if (!values) return false;
  for (size_t i = 0; i < color.size(); ++i) {
    if (!set_part((*values)[i + 1], color[i])) return false;
  }
  wire::TransferPoint& point = *transfer.add_points();
  point.set_value((*values)[0]);
  point.mutable_color()->set_red(color[0]);
  point.mutable_color()->set_green(color[1]);
  point.mutable_color()->set_blue(color[2]);
  point.set_opacity((*values)[4]);
  return true;
}

bool add_points(wire::TransferFunction& transfer, std::string_view text) {
  while (true) {
    const size_t end = text.find(';');
    if (!add_point(transfer, text.substr(0, end))) return false;
    if (end == std::string_view::npos) return true;
    text.remove_prefix(end + 1);
  }
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

bool set_transfer(wire::DrawPicture& picture, std::string_view text) {
  wire::TransferFunction transfer;
  if (!set_preset(transfer, text) && !add_points(transfer, text)) return false;
  *picture.mutable_transfer() = std::move(transfer);
  return true;
}

bool set_shaded(wire::DrawPicture& picture, std::string_view text) {
  if (text != "on" && text != "off") return false;
  picture.set_shaded(text == "on");
  return true;
}

}  // namespace

std::optional<wire::TransferPreset> parse_transfer_preset(std::string_view name) {
  constexpr std::array<std::string_view, 4> kNames{"gray", "ct-bone", "ct-soft", "mr"};
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<wire::TransferPreset>(found - kNames.begin());
}

bool set_volume_field(wire::DrawPicture& picture, std::string_view name, std::string_view text) {
  if (name == "transfer") return set_transfer(picture, text);
  return name == "shaded" && set_shaded(picture, text);
}

}  // namespace surfcast::protocol
