#include "protocol/picture_fields.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "protocol/display_fields.h"
#include "protocol/glyph_fields.h"
#include "protocol/parse.h"
#include "protocol/volume_fields.h"

namespace surfcast::protocol {
namespace {

constexpr std::array kFields{
    PictureField{"position", "camera-position", "X,Y,Z", "position of the eye, world coordinates"},
    PictureField{"focal_point", "camera-focal-point", "X,Y,Z", "point that the eye looks at, world coordinates"},
    PictureField{"view_up", "camera-view-up", "X,Y,Z", "up direction of the picture (default: the vertical axis)"},
    PictureField{"view_angle", "camera-view-angle", "DEGREES", "vertical field of view, in (0, 180) (default 30)"},
    PictureField{"resolution", "resolution", "W,H", "size of the picture, pixels (default 1280,720)"},
    PictureField{"format", "format", "png|jpg|webp|exr", "format of the picture file"},
    PictureField{"quality", "quality", "1..100", "quality of JPEG and WebP (default 90)"},
    PictureField{"channels", "channels", "NAME,NAME,...",
                 "add channels to an EXR file: depth, normal, position, coverage, classification, surfel", false, true},
    PictureField{"normalization", "normalization", "pixel|surfel",
                 "normalization of overlapping splats, per pixel or per surfel (default pixel)"},
    PictureField{"filter", "filter", "ewa|none", "anti-aliasing prefilter (default ewa)"},
    PictureField{"spacing", "spacing", "PIXELS",
                 "projected surfel spacing at which refinement stops; 0: the finest level (default 0)"},
    PictureField{"error", "error", "DB",
                 "choose the spacing by error: the PSNR against the finest level, in place of --spacing"},
    PictureField{"time", "time", "MS",
                 "choose the spacing by time: milliseconds to draw and encode, in place of --spacing"},
    PictureField{"shading", "shading", "auto|unlit|lit", "lighting of the surfels (default auto)"},
    PictureField{"splat_convention", "splat-convention", "trained|exact",
                 "models of Gaussians as they were trained, or exact in perspective (default trained)"},
    PictureField{"background", "background", "R,G,B", "background colour, 0 to 255 each (default 0,0,0)"},
    PictureField{
        "color_by", "color-by", "rgb|intensity|elevation|classification|normal|direction|dec|fa|mode|md|attribute:NAME",
        "property shown as colour; from direction on, those of ellipsoids (default rgb: the scanned colour; of "
        "tensors their direction)"},
    PictureField{"color_map", "color-map", "viridis|turbo|gray|terrain",
                 "colour map of intensity, elevation and attributes of ellipsoids (default viridis)"},
    PictureField{"color_range", "color-range", "FIRST,LAST",
                 "values of the first and the last colour of the map (default: the model's range)"},
    PictureField{"hide_classes", "hide-classes", "CODE,CODE,...", "classification codes to hide, 0 to 255 each"},
    PictureField{"clip_box", "clip-box", "X0,Y0,Z0,X1,Y1,Z1;...",
                 "show only surfels inside the box (inside any of several boxes), world coordinates", true},
    PictureField{"clip_out", "clip-out", "X0,Y0,Z0,X1,Y1,Z1;...",
                 "hide surfels inside the box (inside any of several boxes), world coordinates", true},
    PictureField{"eye_dome", "eye-dome", "STRENGTH[,RADIUS]",
                 "darken pixels behind depth discontinuities: strength 0 to 100, usually 1; radius up to 8 pixels "
                 "(default 0,1.5)"},
    PictureField{"transfer", "transfer", "NAME[,FIRST,LAST]|VALUE,R,G,B,OPACITY;...",
                 "colours and opacities of volumes: auto (default), gray, ct-bone, ct-soft or mr, with the values at "
                 "its ends; or "
                 "points "
                 "in ascending order, with the opacity of one spacing of the grid; or on the command line a JSON file "
                 "(default gray)"},
    PictureField{"shaded", "shaded", "on|off",
                 "lighting of volumes (default: on with the transfer function auto, else off)"},
    PictureField{"iso", "iso", "VALUE[,R,G,B[,OPACITY]];...",
                 "surfaces of volumes where they have a value, lit (default colour light grey, opacity 1)", true},
    PictureField{"slice", "slice", "X,Y,Z,NX,NY,NZ|i,INDEX|j,INDEX|k,INDEX;...",
                 "planes through volumes in the colours of the transfer function: a point and a normal in world "
                 "coordinates, or an index along an axis of the grid",
                 true},
    PictureField{"medium", "medium", "on|off",
                 "show what the transfer function shows of volumes (default on; off with --iso or --slice and without "
                 "--transfer)"},
    PictureField{"opacity", "opacity", "FACTOR",
                 "factor of the opacities of surfels, volumes, Gaussians and ellipsoids, 0 to 1 (default 1)"},
    PictureField{"opacity_by_class", "opacity-by-class", "CODE=FACTOR,...",
                 "factors of the opacities of surfels by classification code, 0 to 1 each"},
    PictureField{"ghost", "ghost", "FACTOR",
                 "factor of the opacities of surfels that clip boxes hide, 0 to 1 (default 0)"},
    PictureField{"xray", "xray", "off|sorted|density",
                 "surfels as in X-rays: thin where they are seen flat, or as a medium (default off)"},
    PictureField{"glyph", "glyph", "ellipsoid|superquadric[,SHARPNESS]",
                 "shape of the glyphs of tensors; sharpness of superquadrics, 0 to 10 (default ellipsoid; 3)"},
    PictureField{"glyph_radius", "glyph-radius", "eigenvalue|root|unit",
                 "semi-axes of glyphs: by eigenvalues, their roots, or divided by the largest (default eigenvalue)"},
    PictureField{"glyph_scale", "glyph-scale", "LENGTH",
                 "semi-axis of a glyph for a value (or root, or ratio) of 1, world units (default: by the model)"},
    PictureField{"threshold", "threshold", "ATTRIBUTE,MIN[,MAX];...",
                 "draw ellipsoids whose attribute lies in the range: fa, mode, md, or a column of the file", true},
    PictureField{
        "lights", "lights", "AMBIENT,SPECULAR,EXPONENT;X,Y,Z,POWER;...",
        "lights on ellipsoids, by their directions: x right, y up, z forward; or on the command line a JSON file "
        "(default: a headlight)"},
};

template <typename Enum>
struct Choice {
  std::string_view name;
  Enum value;
};

constexpr std::array kFormats{
    Choice<wire::FileFormat>{"png", wire::FILE_FORMAT_PNG},   Choice<wire::FileFormat>{"jpg", wire::FILE_FORMAT_JPEG},
    Choice<wire::FileFormat>{"jpeg", wire::FILE_FORMAT_JPEG}, Choice<wire::FileFormat>{"webp", wire::FILE_FORMAT_WEBP},
    Choice<wire::FileFormat>{"exr", wire::FILE_FORMAT_EXR},
};
constexpr std::array kNormalizations{
    Choice<wire::Normalization>{"pixel", wire::NORMALIZATION_PIXEL},
    Choice<wire::Normalization>{"surfel", wire::NORMALIZATION_SURFEL},
};
constexpr std::array kFilters{
    Choice<wire::Filter>{"ewa", wire::FILTER_EWA},
    Choice<wire::Filter>{"none", wire::FILTER_NONE},
};
constexpr std::array kSplatConventions{
    Choice<wire::SplatConvention>{"trained", wire::SPLAT_CONVENTION_TRAINED},
    Choice<wire::SplatConvention>{"exact", wire::SPLAT_CONVENTION_EXACT},
};
constexpr std::array kShadings{
    Choice<wire::Shading>{"auto", wire::SHADING_AUTO},
    Choice<wire::Shading>{"unlit", wire::SHADING_UNLIT},
    Choice<wire::Shading>{"lit", wire::SHADING_LIT},
};

constexpr std::array kChannels{
    Choice<wire::Channel>{"depth", wire::CHANNEL_DEPTH},
    Choice<wire::Channel>{"normal", wire::CHANNEL_NORMAL},
    Choice<wire::Channel>{"position", wire::CHANNEL_POSITION},
    Choice<wire::Channel>{"coverage", wire::CHANNEL_COVERAGE},
    Choice<wire::Channel>{"classification", wire::CHANNEL_CLASSIFICATION},
    Choice<wire::Channel>{"surfel", wire::CHANNEL_SURFEL},
};

template <typename Choices>
auto choose(const Choices& choices, std::string_view text) {
  std::optional<decltype(choices[0].value)> value;
  for (const auto& choice : choices) {
    if (choice.name == text) value = choice.value;
  }
  return value;
}

// Each setter stores the value of `text`, or returns false and leaves the picture as it was.

bool set_vector(wire::Vector3* vector, std::string_view text) {
  const auto values = parse_doubles(text, 3);
  if (!values) return false;
  vector->set_x((*values)[0]);
  vector->set_y((*values)[1]);
  vector->set_z((*values)[2]);
  return true;
}

bool set_view_angle(wire::DrawPicture& picture, std::string_view text) {
  const auto value = parse_double(text);
  if (!value || !(*value > 0 && *value < 180)) return false;
  picture.mutable_camera()->set_view_angle(*value);
  return true;
}

bool set_resolution(wire::DrawPicture& picture, std::string_view text) {
  const auto values = parse_unsigneds(text, 2);
  if (!values || (*values)[0] == 0 || (*values)[1] == 0) return false;
  picture.mutable_resolution()->set_width((*values)[0]);
  picture.mutable_resolution()->set_height((*values)[1]);
  return true;
}

bool set_quality(wire::DrawPicture& picture, std::string_view text) {
  const auto value = parse_unsigned(text);
  if (!value || *value < 1 || *value > 100) return false;
  picture.set_quality(*value);
  return true;
}

bool set_spacing(wire::DrawPicture& picture, std::string_view text) {
  const auto value = parse_double(text);
  if (!value || *value < 0) return false;
  picture.set_spacing(*value);
  return true;
}

/// Sets a number above 0.
template <typename Set>
bool set_positive(std::string_view text, Set set) {
  const auto value = parse_double(text);
  if (!value || *value <= 0) return false;
  set(*value);
  return true;
}

bool set_background(wire::DrawPicture& picture, std::string_view text) {
  const auto values = parse_unsigneds(text, 3);
  if (!values || (*values)[0] > 255 || (*values)[1] > 255 || (*values)[2] > 255) return false;
  picture.mutable_background()->set_red((*values)[0]);
  picture.mutable_background()->set_green((*values)[1]);
  picture.mutable_background()->set_blue((*values)[2]);
  return true;
}

bool set_channels(wire::DrawPicture& picture, std::string_view text) {
  std::vector<int> channels;
  for (size_t end = 0; end != std::string_view::npos;) {
    end = text.find(',');
    const auto channel = choose(kChannels, text.substr(0, end));
    if (!channel) return false;
    channels.push_back(*channel);
    text.remove_prefix(std::min(end, text.size() - 1) + 1);
  }
  picture.mutable_channels()->Assign(channels.begin(), channels.end());
  return true;
}

template <typename Choices, typename Setter>
bool set_choice(const Choices& choices, std::string_view text, Setter set) {
  const auto value = choose(choices, text);
  if (value) set(*value);
  return value.has_value();
}

bool set_by_name(wire::DrawPicture& picture, std::string_view name, std::string_view text) {
  if (name == "position") return set_vector(picture.mutable_camera()->mutable_position(), text);
  if (name == "focal_point") return set_vector(picture.mutable_camera()->mutable_focal_point(), text);
  if (name == "view_up") return set_vector(picture.mutable_camera()->mutable_view_up(), text);
  if (name == "view_angle") return set_view_angle(picture, text);
  if (name == "resolution") return set_resolution(picture, text);
  if (name == "format") return set_choice(kFormats, text, [&](auto value) { picture.set_format(value); });
  if (name == "quality") return set_quality(picture, text);
  if (name == "channels") return set_channels(picture, text);
  if (name == "normalization") {
    return set_choice(kNormalizations, text, [&](auto value) { picture.set_normalization(value); });
  }
  if (name == "filter") return set_choice(kFilters, text, [&](auto value) { picture.set_filter(value); });
  if (name == "spacing") return set_spacing(picture, text);
  if (name == "error") return set_positive(text, [&](double value) { picture.set_error(value); });
  if (name == "time") return set_positive(text, [&](double value) { picture.set_time_ms(value); });
  if (name == "shading") return set_choice(kShadings, text, [&](auto value) { picture.set_shading(value); });
  if (name == "splat_convention") {
    return set_choice(kSplatConventions, text, [&](auto value) { picture.set_splat_convention(value); });
  }
  if (name == "background") return set_background(picture, text);
  return set_display_field(picture, name, text) || set_volume_field(picture, name, text) ||
         set_glyph_field(picture, name, text);
}

}  // namespace

std::span<const PictureField> picture_fields() {
  return kFields;
}

Status set_picture_field(wire::DrawPicture& picture, std::string_view name, std::string_view text) {
  for (const PictureField& field : kFields) {
    if (field.name != name) continue;
    if (set_by_name(picture, name, text)) return {};
    return fail(ErrorKind::kInvalidInput,
                std::string(name) + ": expected " + std::string(field.form) + ", got '" + std::string(text) + "'");
  }
  return fail(ErrorKind::kNotFound, "there is no parameter '" + std::string(name) + "'");
}

Status set_pixel(wire::PickSurfel& pick, std::string_view text) {
  const auto values = parse_unsigneds(text, 2);
  if (!values) return fail(ErrorKind::kInvalidInput, "pixel: expected X,Y, got '" + std::string(text) + "'");
  pick.set_x((*values)[0]);
  pick.set_y((*values)[1]);
  return {};
}

Result<wire::FileFormat> parse_file_format(std::string_view text) {
  if (const auto format = choose(kFormats, text)) return *format;
  return fail(ErrorKind::kUnsupported, "'" + std::string(text) + "' is not a picture format: png, jpg, webp, exr");
}

std::string_view name_of(wire::FileFormat format) {
  switch (format) {
    case wire::FILE_FORMAT_JPEG:
      return "jpeg";
    case wire::FILE_FORMAT_WEBP:
      return "webp";
    case wire::FILE_FORMAT_EXR:
      return "exr";
    default:
      return "png";
  }
}

std::string_view media_type(wire::FileFormat format) {
  switch (format) {
    case wire::FILE_FORMAT_JPEG:
      return "image/jpeg";
    case wire::FILE_FORMAT_WEBP:
      return "image/webp";
    case wire::FILE_FORMAT_EXR:
      return "image/x-exr";
    default:
      return "image/png";
  }
}

}  // namespace surfcast::protocol
