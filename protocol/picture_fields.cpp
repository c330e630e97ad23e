#include "protocol/picture_fields.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "protocol/display_fields.h"
#include "protocol/field_values.h"
#include "protocol/glyph_fields.h"
#include "protocol/parse.h"
#include "protocol/volume_fields.h"

namespace surfcast::protocol {
namespace {

template <typename Enum>
struct Choice {
  std::string_view name;
  Enum value;
};

constexpr std::array kFileFormats{
    Choice<wire::FileFormat>{"png", wire::FILE_FORMAT_PNG},   Choice<wire::FileFormat>{"jpg", wire::FILE_FORMAT_JPEG},
    Choice<wire::FileFormat>{"jpeg", wire::FILE_FORMAT_JPEG}, Choice<wire::FileFormat>{"webp", wire::FILE_FORMAT_WEBP},
    Choice<wire::FileFormat>{"exr", wire::FILE_FORMAT_EXR},
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

bool set_position(wire::DrawPicture& picture, std::string_view text) {
  return set_vector(picture.mutable_camera()->mutable_position(), text);
}

bool set_focal_point(wire::DrawPicture& picture, std::string_view text) {
  return set_vector(picture.mutable_camera()->mutable_focal_point(), text);
}

bool set_view_up(wire::DrawPicture& picture, std::string_view text) {
  return set_vector(picture.mutable_camera()->mutable_view_up(), text);
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

bool set_format(wire::DrawPicture& picture, std::string_view text) {
  const auto format = choose(kFileFormats, text);
  if (format) picture.set_format(*format);
  return format.has_value();
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

// Accessors of values that are members of a member.

wire::ColorMap color_map(const wire::DrawPicture& picture) {
  return picture.coloring().map();
}

void set_color_map(wire::DrawPicture& picture, wire::ColorMap map) {
  picture.mutable_coloring()->set_map(map);
}

wire::GlyphRadius glyph_radius(const wire::DrawPicture& picture) {
  return picture.glyphs().radius();
}

void set_glyph_radius(wire::DrawPicture& picture, wire::GlyphRadius radius) {
  picture.mutable_glyphs()->set_radius(radius);
}

double glyph_scale(const wire::DrawPicture& picture) {
  return picture.glyphs().scale();
}

bool has_glyph_scale(const wire::DrawPicture& picture) {
  return picture.glyphs().has_scale();
}

void set_glyph_scale(wire::DrawPicture& picture, double scale) {
  picture.mutable_glyphs()->set_scale(scale);
}

using Picture = wire::DrawPicture;
using Plain = picture::PlainOptions;

// The last part of a row states the kind of the value, its accessors and place in the message, its member of
// PlainOptions, its range, and what it is in a link of the viewer that does not state it. There the background is
// slightly darker than the panels, so that the picture appears to be behind them.
constexpr std::array kFields{
    PictureField{"position", "camera-position", "X,Y,Z", "position of the eye, world coordinates",
                 structured<&set_position>("camera.position")},
    PictureField{"focal_point", "camera-focal-point", "X,Y,Z", "point that the eye looks at, world coordinates",
                 structured<&set_focal_point>("camera.focal_point")},
    PictureField{"view_up", "camera-view-up", "X,Y,Z", "up direction of the picture (default: the vertical axis)",
                 structured<&set_view_up>("camera.view_up")},
    PictureField{"view_angle", "camera-view-angle", "DEGREES", "vertical field of view, in (0, 180) (default 30)",
                 structured<&set_view_angle>("camera.view_angle")},
    PictureField{"resolution", "resolution", "W,H", "size of the picture, pixels (default 1280,720)",
                 structured<&set_resolution>("resolution")},
    PictureField{"format", "format", "png|jpg|webp|exr", "format of the picture file",
                 structured<&set_format>("format")},
    PictureField{"quality", "quality", "1..100", "quality of JPEG and WebP (default 90)",
                 structured<&set_quality>("quality")},
    PictureField{"channels", "channels", "NAME,NAME,...",
                 "add channels to an EXR file: depth, normal, position, coverage, classification, surfel",
                 structured<&set_channels>("channels"), false, true},
    PictureField{
        "normalization", "normalization", "pixel|surfel",
        "normalization of overlapping splats, per pixel or per surfel (default pixel)",
        choice<&Picture::normalization, &Picture::set_normalization, &Plain::normalization>({"normalization"})},
    PictureField{"filter", "filter", "ewa|none", "anti-aliasing prefilter (default ewa)",
                 choice<&Picture::filter, &Picture::set_filter, &Plain::filter>({"filter"})},
    PictureField{
        "spacing", "spacing", "PIXELS",
        "projected surfel spacing at which refinement stops; 0: the finest level (default 0)",
        number<&Picture::spacing, &Picture::set_spacing, &Plain::spacing>({.unit = "pixels"}, {"spacing", "1"})},
    PictureField{"error", "error", "DB",
                 "choose the spacing by error: the PSNR against the finest level, in place of --spacing",
                 number<&Picture::error, &Picture::set_error, &Plain::error>({.above = true, .unit = "dB"}, {"error"})},
    PictureField{"time", "time", "MS",
                 "choose spacing and render scale by time: milliseconds to draw and encode, in place of --spacing",
                 number<&Picture::time_ms, &Picture::set_time_ms, &Plain::time_ms>(
                     {.above = true, .unit = "milliseconds"}, {"time_ms"})},
    PictureField{
        "render_scale", "render-scale", "SHARE",
        "share of its sides at which the picture is drawn before it is enlarged, at most 1 (default 1)",
        number<&Picture::render_scale, &Picture::set_render_scale, &Plain::render_scale, &Picture::has_render_scale>(
            {.most = 1, .above = true}, {"render_scale"})},
    PictureField{"shading", "shading", "auto|unlit|lit", "lighting of the surfels (default auto)",
                 choice<&Picture::shading, &Picture::set_shading, &Plain::shading>({"shading", "auto"})},
    PictureField{"splat_convention", "splat-convention", "trained|exact",
                 "models of Gaussians as they were trained, or exact in perspective (default trained)",
                 choice<&Picture::splat_convention, &Picture::set_splat_convention, &Plain::splat_convention>(
                     {"splat_convention", "trained"})},
    PictureField{
        "background", "background", "R,G,B", "background colour, 0 to 255 each (default 0,0,0)",
        color<&Picture::background, &Picture::mutable_background, &Plain::background>({"background", "14,18,22"})},
    PictureField{
        "color_by", "color-by", "rgb|intensity|elevation|classification|normal|direction|dec|fa|mode|md|attribute:NAME",
        "property shown as colour; from direction on, those of ellipsoids (default rgb: the scanned colour; of "
        "tensors their direction)",
        structured<&set_color_source>("coloring.source")},
    PictureField{"color_map", "color-map", "viridis|turbo|gray|terrain",
                 "colour map of intensity, elevation and attributes of ellipsoids (default viridis)",
                 choice<&color_map, &set_color_map>({"coloring.map"})},
    PictureField{"color_range", "color-range", "FIRST,LAST",
                 "values of the first and the last colour of the map (default: the model's range)",
                 structured<&set_color_range>("coloring.first")},
    PictureField{"hide_classes", "hide-classes", "CODE,CODE,...", "classification codes to hide, 0 to 255 each",
                 structured<&set_hidden_classes>("hidden_classes")},
    PictureField{"hide_models", "hide-models", "NAME,NAME,...", "models to hide of several that are shown together",
                 structured<&set_hidden_models>("hidden_models")},
    PictureField{"clip_box", "clip-box", "X0,Y0,Z0,X1,Y1,Z1;...",
                 "show only surfels inside the box (inside any of several boxes), world coordinates",
                 structured<&set_boxes_to_show>("clip_boxes"), true},
    PictureField{"clip_out", "clip-out", "X0,Y0,Z0,X1,Y1,Z1;...",
                 "hide surfels inside the box (inside any of several boxes), world coordinates",
                 structured<&set_boxes_to_hide>("clip_boxes"), true},
    PictureField{"eye_dome", "eye-dome", "STRENGTH[,RADIUS]",
                 "darken pixels behind depth discontinuities: strength 0 to 100, usually 1; radius up to 8 pixels "
                 "(default 0,1.5)",
                 structured<&set_eye_dome>("eye_dome")},
    PictureField{"transfer", "transfer", "NAME[,FIRST,LAST]|VALUE,R,G,B,OPACITY;...",
                 "colours and opacities of volumes: auto (default), gray, ct-bone, ct-soft or mr, with the values at "
                 "its ends; or points in ascending order, with the opacity of one spacing of the grid; or on the "
                 "command line a JSON file",
                 structured<&set_transfer>("transfer")},
    PictureField{"shaded", "shaded", "on|off",
                 "lighting of volumes (default: on with the transfer function auto, else off)",
                 toggle<&Picture::set_shaded>({"shaded", ""})},
    PictureField{"iso", "iso", "VALUE[,R,G,B[,OPACITY]];...",
                 "surfaces of volumes where they have a value, lit (default colour light grey, opacity 1)",
                 structured<&set_iso_surfaces>("iso_surfaces"), true},
    PictureField{"slice", "slice", "X,Y,Z,NX,NY,NZ|i,INDEX|j,INDEX|k,INDEX;...",
                 "planes through volumes in the colours of the transfer function: a point and a normal in world "
                 "coordinates, or an index along an axis of the grid",
                 structured<&set_slices>("slices"), true},
    PictureField{"medium", "medium", "on|off",
                 "show what the transfer function shows of volumes (default on; off with --iso or --slice and without "
                 "--transfer)",
                 toggle<&Picture::set_medium>({"medium", ""})},
    PictureField{"opacity", "opacity", "FACTOR",
                 "factor of the opacities of surfels, volumes, Gaussians and ellipsoids, 0 to 1 (default 1)",
                 number<&Picture::opacity, &Picture::set_opacity, &Plain::opacity, &Picture::has_opacity>(
                     {.most = 1}, {"opacity", "1"})},
    PictureField{"opacity_by_class", "opacity-by-class", "CODE=FACTOR,...",
                 "factors of the opacities of surfels by classification code, 0 to 1 each",
                 structured<&set_class_opacities>("class_opacities")},
    PictureField{"ghost", "ghost", "FACTOR",
                 "factor of the opacities of surfels that clip boxes hide, 0 to 1 (default 0)",
                 number<&Picture::ghost, &Picture::set_ghost, &Plain::ghost>({.most = 1}, {"ghost", "0"})},
    PictureField{"xray", "xray", "off|sorted|density",
                 "surfels as in X-rays: thin where they are seen flat, or as a medium (default off)",
                 choice<&Picture::xray, &Picture::set_xray, &Plain::xray>({"xray", "off"})},
    PictureField{"glyph", "glyph", "ellipsoid|superquadric[,SHARPNESS]",
                 "shape of the glyphs of tensors; sharpness of superquadrics, 0 to 10 (default ellipsoid; 3)",
                 structured<&set_glyph>("glyphs.shape")},
    PictureField{"glyph_radius", "glyph-radius", "eigenvalue|root|unit",
                 "semi-axes of glyphs: by eigenvalues, their roots, or divided by the largest (default eigenvalue)",
                 choice<&glyph_radius, &set_glyph_radius>({"glyphs.radius"})},
    PictureField{"glyph_scale", "glyph-scale", "LENGTH",
                 "semi-axis of a glyph for a value (or root, or ratio) of 1, world units (default: by the model)",
                 number<&glyph_scale, &set_glyph_scale, nullptr, &has_glyph_scale>({.above = true}, {"glyphs.scale"})},
    PictureField{"threshold", "threshold", "ATTRIBUTE,MIN[,MAX];...",
                 "draw ellipsoids whose attribute lies in the range: fa, mode, md, or a column of the file",
                 structured<&set_thresholds>("glyphs.thresholds"), true},
    PictureField{
        "lights", "lights", "AMBIENT,SPECULAR,EXPONENT;X,Y,Z,POWER;...",
        "lights on ellipsoids, by their directions: x right, y up, z forward; or on the command line a JSON file "
        "(default: a headlight)",
        structured<&set_lights>("lighting")},
};

}  // namespace

std::span<const PictureField> picture_fields() {
  return kFields;
}

Status set_picture_field(wire::DrawPicture& picture, std::string_view name, std::string_view text) {
  for (const PictureField& field : kFields) {
    if (field.name != name) continue;
    if (field.value.parse(field, picture, text)) return {};
    return fail(ErrorKind::kInvalidInput,
                std::string(name) + ": expected " + std::string(field.form) + ", got '" + std::string(text) + "'");
  }
  return fail(ErrorKind::kNotFound, "there is no parameter '" + std::string(name) + "'");
}

Status check_plain_fields(const wire::DrawPicture& picture) {
  for (const PictureField& field : kFields) {
    if (field.value.check == nullptr) continue;
    if (Status status = field.value.check(field, picture); !status) return status;
  }
  return {};
}

picture::PlainOptions plain_options(const wire::DrawPicture& picture) {
  picture::PlainOptions options;
  for (const PictureField& field : kFields) {
    if (field.value.read != nullptr) field.value.read(picture, options);
  }
  return options;
}

Status set_pixel(wire::PickSurfel& pick, std::string_view text) {
  const auto values = parse_unsigneds(text, 2);
  if (!values) return fail(ErrorKind::kInvalidInput, "pixel: expected X,Y, got '" + std::string(text) + "'");
  pick.set_x((*values)[0]);
  pick.set_y((*values)[1]);
  return {};
}

Result<wire::FileFormat> parse_file_format(std::string_view text) {
  if (const auto format = choose(kFileFormats, text)) return *format;
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
