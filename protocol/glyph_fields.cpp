#include "protocol/glyph_fields.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "protocol/parse.h"
#include "protocol/validate.h"

namespace surfcast::protocol {
namespace {

/// ATTRIBUTE,MIN or ATTRIBUTE,MIN,MAX. Names may contain commas: the numbers are the last parts.
bool set_threshold(wire::Threshold& threshold, std::string_view text) {
  for (const size_t count : {size_t{2}, size_t{1}}) {
    size_t comma = text.size();
    for (size_t i = 0; i < count && comma != std::string_view::npos; ++i) {
      comma = comma == 0 ? std::string_view::npos : text.rfind(',', comma - 1);
    }
    if (comma == std::string_view::npos || comma == 0 || comma > kMaxAttributeBytes) continue;
    const auto range = parse_doubles(text.substr(comma + 1), count);
    if (!range) continue;
    threshold.set_attribute(std::string(text.substr(0, comma)));
    threshold.set_smallest((*range)[0]);
    if (count == 2) threshold.set_largest((*range)[1]);
    return count == 1 || (*range)[0] <= (*range)[1];
  }
  return false;
}

bool set_light(wire::Light& light, std::string_view text) {
  const auto values = parse_doubles(text, 4);
  if (!values || !((*values)[3] >= 0)) return false;
  light.mutable_direction()->set_x((*values)[0]);
  light.mutable_direction()->set_y((*values)[1]);
  light.mutable_direction()->set_z((*values)[2]);
  light.set_power((*values)[3]);
  return (*values)[0] != 0 || (*values)[1] != 0 || (*values)[2] != 0;
}

}  // namespace

bool set_glyph(wire::DrawPicture& picture, std::string_view text) {
  const size_t comma = text.find(',');
  const std::optional<int> shape = parse_choice("ellipsoid|superquadric", text.substr(0, comma));
  if (!shape) return false;
  if (comma != std::string_view::npos) {
    const std::optional<double> sharpness = parse_double(text.substr(comma + 1));
    if (!sharpness || !(*sharpness >= 0 && *sharpness <= kMaxSharpness)) return false;
    picture.mutable_glyphs()->set_sharpness(*sharpness);
  }
  picture.mutable_glyphs()->set_shape(static_cast<wire::GlyphShape>(*shape));
  return true;
}

bool set_thresholds(wire::DrawPicture& picture, std::string_view text) {
  google::protobuf::RepeatedPtrField<wire::Threshold> thresholds;
  for (size_t end = 0; end != std::string_view::npos;) {
    end = text.find(';');
    if (!set_threshold(*thresholds.Add(), text.substr(0, end))) return false;
    text.remove_prefix(std::min(end, text.size() - 1) + 1);
  }
  if (thresholds.size() > kMaxThresholds) return false;
  picture.mutable_glyphs()->mutable_thresholds()->Swap(&thresholds);
  return true;
}

bool set_lights(wire::DrawPicture& picture, std::string_view text) {
  size_t end = text.find(';');
  const auto terms = parse_doubles(text.substr(0, end), 3);
  if (!terms || end == std::string_view::npos || std::ranges::any_of(*terms, [](double t) { return t < 0; })) {
    return false;
  }
  wire::Lighting lighting;
  lighting.set_ambient((*terms)[0]);
  lighting.set_specular((*terms)[1]);
  lighting.set_exponent((*terms)[2]);
  while (end != std::string_view::npos) {
    text.remove_prefix(end + 1);
    end = text.find(';');
    if (!set_light(*lighting.add_lights(), text.substr(0, end))) return false;
  }
  if (lighting.lights_size() > kMaxLights) return false;
  *picture.mutable_lighting() = std::move(lighting);
  return true;
}

}  // namespace surfcast::protocol
