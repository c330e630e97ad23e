#include "render/programs.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "gl/program.h"
#include "render/shader_library.h"
#include "shared/ellipsoid_layout.h"
#include "shared/frame_layout.h"
#include "shared/gaussian_layout.h"
#include "shared/kernel.h"

namespace surfcast::render {
namespace {

Result<gl::Program> compute_program(const std::string& name, const std::string& file,
                                    std::span<const EmbeddedShader> more, const std::string& defines) {
  Result<std::string> text = shader_text(file, more);
  if (!text) return fail(text);
  return gl::make_program(name.c_str(), {{GL_COMPUTE_SHADER, name, *text}}, defines);
}

/// The defines that the projection and the splat kernel have in common.
std::string common_defines(const Variant& variant) {
  std::string defines;
  if (variant.colored) defines += "#define SURFCAST_HAS_COLOR\n";
  if (variant.lit) defines += "#define SURFCAST_LIT\n";
  if (variant.colored && variant.lit) defines += "#define SURFCAST_LIT_COLOR\n";
  return defines;
}

std::string color_defines(picture::SurfelColor color) {
  switch (color) {
    case picture::SurfelColor::kIntensity:
      return "#define SURFCAST_COLOR_TABLE\n#define SURFCAST_BY_INTENSITY\n";
    case picture::SurfelColor::kElevation:
      return "#define SURFCAST_COLOR_TABLE\n#define SURFCAST_BY_HEIGHT\n";
    case picture::SurfelColor::kClassification:
      return "#define SURFCAST_COLOR_TABLE\n#define SURFCAST_BY_CLASS\n";
    case picture::SurfelColor::kNormal:
      return "#define SURFCAST_COLOR_NORMAL\n";
    case picture::SurfelColor::kStored:
    case picture::SurfelColor::kDirection:
    case picture::SurfelColor::kDec:
    case picture::SurfelColor::kAttribute:
      break;
  }
  return {};
}

/// Of the passes that draw or find silhouettes of surfels with curvature, and of the projection for them.
std::string samples_define(const Variant& variant) {
  return variant.curved ? "#define SURFCAST_SAMPLES_CURVED\n" : "";
}

/// Samples of a pixel at a silhouette in tiles with large splats.
int samples_of_large(const Variant& variant) {
  return variant.curved ? SURFCAST_CURVED_SAMPLES : SURFCAST_SILHOUETTE_SAMPLES;
}

std::string project_defines(const Variant& variant) {
  std::string defines = common_defines(variant) + color_defines(variant.color);
  if (variant.hides_classes) defines += "#define SURFCAST_HIDES_CLASSES\n";
  if (variant.clipped) defines += "#define SURFCAST_CLIPPED\n";
  if (variant.scatter) defines += "#define SURFCAST_SCATTER\n";
  if (variant.curved) defines += "#define SURFCAST_CURVED\n" + samples_define(variant);
  if (variant.transparent) defines += "#define SURFCAST_TRANSPARENT\n";
  if (variant.by_file) defines += "#define SURFCAST_OPACITY_OF_FILE\n";
  if (variant.by_class) defines += "#define SURFCAST_OPACITY_BY_CLASS\n";
  if (variant.ghosts) defines += "#define SURFCAST_GHOSTS\n";
  if (variant.xray) defines += "#define SURFCAST_XRAY\n";
  return defines;
}

std::string float_define(const Variant& variant) {
  return variant.float_picture ? "#define SURFCAST_FLOAT_PICTURE\n" : "";
}

std::string fronts_define(bool kept) {
  return kept ? "#define SURFCAST_KEEPS_FRONTS\n" : "";
}

/// Of what the splat kernel keeps of each pixel.
std::string kept_defines(const Variant& variant) {
  return fronts_define(variant.keeps_fronts()) + (variant.shown_depths ? "#define SURFCAST_KEEPS_DEPTHS\n" : "");
}

std::string layers_define(const Variant& variant) {
  return variant.layered ? "#define SURFCAST_LAYERS\n" : "";
}

std::string splat_defines(const Variant& variant) {
  const std::string output = variant.eye_dome ? "#define SURFCAST_EYE_DOME\n" : float_define(variant);
  const std::string layers = layers_define(variant);
  const std::string behind = variant.blends_behind ? "#define SURFCAST_BLENDS_BEHIND\n" : "";
  const std::string medium = variant.density ? "#define SURFCAST_DENSITY\n" : "";
  return common_defines(variant) + output + layers + behind + medium;
}

/// The kernel that draws tiles.
const char* tile_kernel(const Variant& variant) {
  return variant.transparent ? "transparent.comp" : "splat.comp";
}

std::string define(const std::string& name, int value) {
  return "#define " + name + " " + std::to_string(value) + "\n";
}

std::string lane_defines(bool whole_tiles) {
  return define("SURFCAST_COLUMNS", whole_tiles ? SURFCAST_TILE_WIDTH : 1) +
         define("SURFCAST_ROWS", whole_tiles ? SURFCAST_TILE_HEIGHT : 1) +
         (whole_tiles ? "#define SURFCAST_DYNAMIC_TILES\n" : "");
}

/// The additions of kinds other than surfels to the splat kernel.
struct KindFragments {
  std::string names;  ///< " with " and the names of the kinds; empty without such kinds
  std::string text;   ///< included by shaders/kinds/exact_list.glsl
};

/// The fragment function of a kind. Surfels have one if they have curvature, for those that show it.
std::string fragment_of(const Variant& variant, const kinds::Kind& kind) {
  if (kind.name() != model::kSurfelKind) return std::string(kind.shaders().fragment);
  if (!variant.curved) return {};
  const bool normals = variant.color == picture::SurfelColor::kNormal;
  return std::string(normals ? "#define SURFCAST_COLOR_NORMAL\n" : "") + "#include \"curved/fragment.glsl\"\n";
}

KindFragments fragments_of(const Variant& variant, const PictureKinds& kinds) {
  KindFragments fragments;
  std::string calls;
  for (const PictureKind& kind : kinds) {
    const std::string fragment = fragment_of(variant, *kind.kind);
    if (fragment.empty()) continue;
    const std::string name(kind.kind->name());
    fragments.names += (fragments.names.empty() ? " with " : ", ") + name;
    fragments.text += fragment;
    calls += "  if (kind == " + std::to_string(kind.number) + "u) return " + name + "_fragment(a, b, c, ray);\n";
  }
  if (fragments.names.empty()) return {};
  fragments.text += "\nFragment fragment_of(uint kind, uvec4 a, uvec4 b, uvec4 c, vec2 ray) {\n" + calls +
                    "  return kNoFragment;\n}\n";
  return fragments;
}

/// Pixels, or samples of a pixel, that a lane draws in tiles with large splats. With software GL, where fetches cost
/// most, they share those of a splat. Records of other kinds are evaluated for one ray at a time, and surfaces that are
/// seen through are drawn pixel by pixel.
int rows_of_large(const KernelShape& shape, const Variant& variant, const KindFragments& fragments) {
  const bool alone = !shape.whole_tiles || variant.transparent || !fragments.names.empty();
  return alone ? 1 : SURFCAST_TILE_HEIGHT;
}
static_assert(SURFCAST_TILE_HEIGHT == SURFCAST_SILHOUETTE_SAMPLES);

/// Invocations of a work group that draws a tile whose list has up to `longest` entries. `pixel_lanes` of them hold the
/// tile's pixels. With many, lists of millions of entries are drawn to the end of all their surfaces. In software there
/// are no more than that takes, because all wait for each other. Their number grows by four, so that programs are few.
int lanes_of_long_list(uint32_t longest, int pixel_lanes, bool software) {
  constexpr uint32_t kEach = SURFCAST_ENTRIES_OF_LANE / SURFCAST_MOST_SURFACES;
  constexpr int kMost = 1024;
  if (!software) return longest > (1U << 16) ? kMost : 256;
  int shares = 2;
  while (shares < kMost && shares * kEach < longest) shares *= 4;
  return std::clamp(shares * pixel_lanes, 32, kMost);
}

}  // namespace

Result<Programs> Programs::create(const KernelShape& shape, const std::string& defines) {
  Programs programs;
  programs.shape_ = shape;
  programs.defines_ = defines + define("SURFCAST_SILHOUETTE_LANES", shape.silhouette_lanes) +
                      (shape.interleaves_groups ? "#define SURFCAST_INTERLEAVES_GROUPS\n" : "") +
                      (shape.shifted_halves ? "#define SURFCAST_SHIFTED_HALVES\n" : "");
  const std::string& all = programs.defines_;
  Result<gl::Program> slices = compute_program("slices.comp", "slices.comp", {}, all);
  if (!slices) return fail(slices);
  Result<gl::Program> offsets = compute_program("bin_offsets.comp", "bin_offsets.comp", {}, all);
  if (!offsets) return fail(offsets);
  Result<gl::Program> bin = compute_program("bin.comp", "bin.comp", {}, all);
  if (!bin) return fail(bin);
  Result<gl::Program> count = compute_program("bin.comp", "bin.comp", {}, all + "#define SURFCAST_COUNTS_LARGE\n");
  if (!count) return fail(count);
  Result<gl::Program> reaches = compute_program("bin.comp", "bin.comp", {}, all + "#define SURFCAST_SELECTS\n");
  if (!reaches) return fail(reaches);
  programs.bin_reaches_ = std::move(*reaches);
  programs.count_large_ = std::move(*count);
  programs.slices_ = std::move(*slices);
  programs.bin_offsets_ = std::move(*offsets);
  programs.bin_ = std::move(*bin);
  return programs;
}

Result<const gl::Program*> Programs::program(const Source& source, const std::string& defines) {
  const std::pair key(source.name, defines);
  if (const auto found = compiled_.find(key); found != compiled_.end()) return &found->second;
  Result<gl::Program> program = compute_program(source.name, source.file, source.files, defines_ + defines);
  if (!program) return fail(program);
  return &compiled_.emplace(key, std::move(*program)).first->second;
}

std::vector<std::string> Programs::compiled() const {
  std::vector<std::string> names;
  for (const auto& [key, program] : compiled_) names.push_back(key.first);
  return names;
}

/// The projection programs of all kinds of a picture.
Result<std::vector<const gl::Program*>> Programs::projections(const Variant& variant, const PictureKinds& kinds) {
  constexpr const char* kFile = "projection of a kind";
  const std::string lanes = define("SURFCAST_PROJECT_LANES", shape_.project_lanes);
  std::vector<const gl::Program*> programs;
  for (const PictureKind& kind : kinds) {
    const kinds::KindShaders shaders = kind.kind->shaders();
    const Source source{"projection of " + std::string(kind.kind->name()), kFile, {{kFile, shaders.project}}};
    const std::string number =
        fragment_of(variant, *kind.kind).empty() ? "" : define("SURFCAST_KIND", static_cast<int>(kind.number));
    std::string defines = project_defines(variant);
    defines += lanes;
    defines += number;
    const Result<const gl::Program*> compiled = program(source, defines);
    if (!compiled) return fail(compiled);
    programs.push_back(*compiled);
  }
  return programs;
}

Result<LongListPrograms> Programs::long_lists(const Variant& variant, const PictureKinds& kinds, uint32_t longest) {
  Variant drawn = variant;
  drawn.blends_behind = false;
  const std::string splat = splat_defines(drawn) + "#define SURFCAST_TOGETHER\n";
  const auto shares = [&](int pixel_lanes) {
    const int lanes = lanes_of_long_list(longest, pixel_lanes, shape_.whole_tiles);
    return define("SURFCAST_PIXEL_LANES", pixel_lanes) + define("SURFCAST_SHARES", lanes / pixel_lanes);
  };
  const KindFragments fragments = fragments_of(variant, kinds);
  const auto compile = [&](const gl::Program*& target, const char* file, bool large,
                           const std::string& defines) -> Status {
    Source source{file, file};
    if (large && !fragments.names.empty()) {
      source = {file + fragments.names, file, {{"kinds/fragment_of.glsl", fragments.text}}};
    }
    const std::string all = splat + defines + (large ? "#define SURFCAST_LARGE\n" : "");
    const Result<const gl::Program*> compiled = program(source, all);
    if (!compiled) return fail(compiled);
    target = *compiled;
    return {};
  };
  constexpr int kPixels = SURFCAST_TILE_WIDTH * SURFCAST_TILE_HEIGHT;
  const std::string kept = kept_defines(variant);
  const int small_lanes = shape_.whole_tiles ? 1 : kPixels;
  LongListPrograms programs;
  Status status = compile(programs.splat, tile_kernel(variant), false,
                          lane_defines(shape_.whole_tiles) + shares(small_lanes) + kept);
  if (status) {
    status = compile(programs.splat_large, tile_kernel(variant), true, lane_defines(false) + shares(kPixels) + kept);
  }
  const std::string selecting = selects(variant) && !variant.transparent ? "#define SURFCAST_SELECTS\n" : "";
  if (status && variant.silhouettes) {
    status = compile(programs.supersample, "supersample.comp", false,
                     define("SURFCAST_COLUMNS", pixels_at_once()) +
                         define("SURFCAST_ROWS", SURFCAST_SILHOUETTE_SAMPLES) + shares(1) + selecting);
  }
  if (status && variant.silhouettes) {
    status = compile(programs.supersample_large, "supersample.comp", true,
                     lane_defines(false) + shares(samples_of_large(variant)) + samples_define(variant) + selecting);
  }
  if (!status) return fail(status);
  return programs;
}

Result<VolumePrograms> Programs::volumes(const Variant& variant, size_t volumes) {
  const std::string several = volumes > 1 ? define("SURFCAST_VOLUMES", static_cast<int>(volumes)) : "";
  const std::string layers = layers_define(variant) + (variant.codes ? "#define SURFCAST_CODES\n" : "");
  const bool gradients = variant.shaded || variant.volume_surfaces;
  const std::string look =
      std::string(variant.clipped ? "#define SURFCAST_CLIPPED\n" : "") +
      (variant.shaded ? "#define SURFCAST_SHADED\n" : "") + (gradients ? "#define SURFCAST_GRADIENTS\n" : "") +
      (variant.volume_surfaces ? "#define SURFCAST_SURFACES\n" : "") + layers + several + fronts_define(variant.depth);
  const std::string name = several.empty() ? "volume.comp" : "volume.comp for several volumes";
  const Result<const gl::Program*> draw = program({name, "volume.comp"}, look);
  if (!draw) return fail(draw);
  constexpr const char* kFilter = "volume_filter.comp";
  const Result<const gl::Program*> rows = program({kFilter, kFilter}, "");
  if (!rows) return fail(rows);
  const Result<const gl::Program*> columns =
      program({kFilter, kFilter}, "#define SURFCAST_COLUMNS_OF_LIGHT\n" + float_define(variant) + layers);
  if (!columns) return fail(columns);
  return VolumePrograms{*draw, *rows, *columns};
}

Result<GaussianPrograms> Programs::gaussians(const Variant& variant, GaussianForm form) {
  constexpr std::array kForms{"", "#define SURFCAST_FLAT\n", "#define SURFCAST_EXACT\n"};
  const std::string form_define = kForms.at(static_cast<size_t>(form));
  const bool rays = form != GaussianForm::kTrained;
  constexpr auto kLanes =
      static_cast<uint32_t>(SURFCAST_TILE_WIDTH * SURFCAST_TILE_HEIGHT / SURFCAST_RAY_GAUSSIAN_PIXELS);
  GaussianPrograms programs;
  programs.key = form == GaussianForm::kExact ? SURFCAST_EXACT_GAUSSIAN_KEY : SURFCAST_GAUSSIAN_KEY;
  programs.record = rays ? SURFCAST_RAY_GAUSSIAN_RECORD : SURFCAST_GAUSSIAN_RECORD;
  programs.round = SURFCAST_GAUSSIAN_ROUND;
  programs.lanes_of_tile = rays ? kLanes : static_cast<uint32_t>(SURFCAST_TILE_HEIGHT / shape_.blend_rows());
  programs.lanes = shape_.whole_tiles ? 8 : 32;
  std::string projection = form_define + define("SURFCAST_PROJECT_LANES", shape_.project_lanes);
  projection += define("SURFCAST_HARMONICS", variant.harmonics);
  if (variant.clipped) projection += "#define SURFCAST_CLIPPED\n";
  const bool keeps_fronts = variant.depth && !variant.keeps;  // else they are kept by what is drawn in between
  const std::string blending = form_define + define("SURFCAST_BLEND_ROWS", shape_.blend_rows()) +
                               define("SURFCAST_BLEND_LANES", static_cast<int>(programs.lanes)) +
                               float_define(variant) + layers_define(variant) +
                               (variant.keeps ? "#define SURFCAST_KEEPS\n" : "") + fronts_define(keeps_fronts);
  const Result<const gl::Program*> project = program({"projection of gaussian", "gaussian/project.comp"}, projection);
  if (!project) return fail(project);
  const char* file = rays ? "gaussian/blend_rays.comp" : "gaussian/blend.comp";
  const Result<const gl::Program*> blend = program({"blending of gaussian", file}, blending);
  if (!blend) return fail(blend);
  programs.project = *project;
  programs.blend = *blend;
  programs.layered = variant.layered;
  programs.keeps_fronts = keeps_fronts;
  if (variant.layered) programs.round = SURFCAST_LAYERED_GAUSSIAN_ROUND;
  programs.keeps = variant.keeps;
  programs.has_near = form == GaussianForm::kFlat;
  return programs;
}

Result<EllipsoidPrograms> Programs::ellipsoids(const Variant& variant, bool mapped, EllipsoidTarget target) {
  EllipsoidPrograms programs;
  programs.samples = variant.blends_behind ? 1 : SURFCAST_GLYPH_SAMPLES;
  programs.record = variant.superquadrics ? SURFCAST_SUPERQUADRIC_RECORD : SURFCAST_ELLIPSOID_RECORD;
  programs.round = variant.superquadrics ? SURFCAST_SUPERQUADRIC_ROUND : SURFCAST_ELLIPSOID_ROUND;
  programs.lanes_of_tile = static_cast<uint32_t>(SURFCAST_TILE_HEIGHT / shape_.blend_rows());
  programs.lanes = shape_.whole_tiles ? 8 : 32;
  const std::string samples = define("SURFCAST_SAMPLES", static_cast<int>(programs.samples));
  const std::string shape = variant.superquadrics ? "#define SURFCAST_SUPERQUADRICS\n" : "";
  const std::string projection = define("SURFCAST_PROJECT_LANES", shape_.project_lanes) + shape +
                                 (variant.clipped ? "#define SURFCAST_CLIPPED\n" : "") +
                                 (mapped ? "#define SURFCAST_GLYPH_COLORS\n" : "");
  const std::string lanes = define("SURFCAST_BLEND_ROWS", shape_.blend_rows()) +
                            define("SURFCAST_BLEND_LANES", static_cast<int>(programs.lanes));
  const auto compile = [this](const gl::Program*& made, const char* name, const char* file,
                              const std::string& defines) -> Status {
    const Result<const gl::Program*> compiled = program({name, file}, defines);
    if (!compiled) return fail(compiled);
    made = *compiled;
    return {};
  };
  Status status = compile(programs.project, "projection of ellipsoid", "ellipsoid/project.comp", projection);
  if (status) {
    status = compile(programs.nearest, "nearest ellipsoid", "ellipsoid/nearest.comp", samples + shape + lanes);
  }
  const std::string layers = target == EllipsoidTarget::kPicture ? "" : "#define SURFCAST_LAYERS\n";
  const std::string written =
      target == EllipsoidTarget::kLayers ? "#define SURFCAST_ADDS_LAYER\n" : float_define(variant);
  if (status) {
    programs.keeps_fronts = variant.depth && target != EllipsoidTarget::kLayers;
    const std::string fronts = fronts_define(programs.keeps_fronts);
    status = compile(programs.shade, "light of ellipsoid", "ellipsoid/shade.comp", samples + shape + layers + fronts);
  }
  constexpr const char* kFilter = "ellipsoid/filter.comp";
  if (status) status = compile(programs.filter_rows, kFilter, kFilter, samples + layers);
  if (status) {
    status = compile(programs.filter_columns, kFilter, kFilter,
                     samples + "#define SURFCAST_FILTERS_COLUMNS\n" + layers + written);
  }
  if (!status) return fail(status);
  return programs;
}

int Programs::pixels_at_once() const {
  return shape_.whole_tiles ? SURFCAST_TILE_WIDTH : 1;
}

Result<SplatPrograms> Programs::variant(const Variant& variant, const PictureKinds& kinds) {
  Result<std::vector<const gl::Program*>> project = projections(variant, kinds);
  if (!project) return fail(project);
  SplatPrograms programs;
  programs.project = std::move(*project);
  const auto compile = [this](const gl::Program*& target, const Source& source, const std::string& defines) -> Status {
    const Result<const gl::Program*> compiled = program(source, defines);
    if (!compiled) return fail(compiled);
    target = *compiled;
    return {};
  };
  const auto plain = [](const char* file) { return Source{file, file}; };
  const KindFragments fragments = fragments_of(variant, kinds);
  const auto with_kinds = [&](const char* file) {
    if (fragments.names.empty()) return plain(file);
    return Source{file + fragments.names, file, {{"kinds/fragment_of.glsl", fragments.text}}};
  };
  const std::string splat = splat_defines(variant);
  const std::string at_once = splat + define("SURFCAST_TILES_AT_ONCE", shape_.tiles_at_once);
  const std::string small = at_once + lane_defines(shape_.whole_tiles);
  const int large_rows = rows_of_large(shape_, variant, fragments);
  const std::string large =
      at_once + define("SURFCAST_COLUMNS", 1) + define("SURFCAST_ROWS", large_rows) + "#define SURFCAST_LARGE\n";
  const std::string kept = kept_defines(variant);
  const std::string selecting = selects(variant) ? "#define SURFCAST_SELECTS\n" : "";
  const char* kernel = tile_kernel(variant);
  Status status = compile(programs.splat, plain(kernel), small + kept + selecting);
  const std::string large_selecting = large_rows == SURFCAST_TILE_HEIGHT ? selecting : "";
  if (status) status = compile(programs.splat_large, with_kinds(kernel), large + kept + large_selecting);
  if (variant.silhouettes) {
    const std::string columns = define("SURFCAST_COLUMNS", pixels_at_once());
    const std::string rows = define("SURFCAST_ROWS", SURFCAST_SILHOUETTE_SAMPLES);
    if (status) status = compile(programs.silhouettes, plain("silhouettes.comp"), columns + samples_define(variant));
    if (status) status = compile(programs.supersample, plain("supersample.comp"), splat + columns + rows + selecting);
    const std::string large_samples = large + samples_define(variant) + large_selecting;
    if (status) status = compile(programs.supersample_large, with_kinds("supersample.comp"), large_samples);
    programs.lanes_of_large_pixel = samples_of_large(variant) / large_rows;
  }
  if (status && selects(variant) && !variant.transparent) {
    const std::string column = at_once + define("SURFCAST_COLUMNS", 1) + define("SURFCAST_ROWS", SURFCAST_TILE_HEIGHT);
    status = compile(programs.behind, plain("behind.comp"), column);
    if (status) {
      status = compile(programs.behind_samples, plain("behind.comp"), column + "#define SURFCAST_SUPERSAMPLED\n");
    }
  }
  if (status && variant.eye_dome && !variant.layered) {
    status = compile(programs.eye_dome, plain("eye_dome.comp"), float_define(variant));
  }
  if (!status) return fail(status);
  return programs;
}  // namespace surfcast::render

}  // namespace surfcast::render
