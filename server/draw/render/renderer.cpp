#include "render/renderer.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <span>
#include <thread>
#include <utility>

#include "base/contract.h"
#include "base/hash.h"
#include "base/host_memory.h"
#include "base/stopwatch.h"
#include "gl/device_status.h"
#include "gl/egl_context.h"
#include "model/hidden_members.h"
#include "render/clear_blocks.h"
#include "render/compose_region.h"
#include "render/draw_to_goal.h"
#include "render/enlarge.h"
#include "render/glyph_plan.h"
#include "render/programs.h"
#include "render/scene.h"
#include "render/splat_buffers.h"
#include "render/survey.h"
#include "render/transfer_presets.h"
#include "render/variant_of_picture.h"
#include "residency/packing.h"

namespace surfcast::render {
namespace {

/// Largest side of a picture, pixels. Not a setting: screen coordinates are single precision, good to a thousandth of a
/// pixel up to here and worse beyond. The service may allow less.
constexpr int kMaxResolution = 16384;

size_t pixel_bytes(picture::PixelFormat format) {
  return format == picture::PixelFormat::kSrgb8 ? 4 : 4 * sizeof(float);
}

selection::Sides sides_of(const DisplayOptions& display) {
  return display.through.any ? selection::Sides::kBoth : selection::Sides::kFront;
}

/// The projected spacing of what clip boxes hide, pixels; none if it is not drawn.
std::optional<double> ghost_spacing(const DisplayOptions& display, const picture::PictureRequest& request) {
  constexpr double kCoarser = 4;
  constexpr double kFinest = 2;
  if (!display.through.ghosts) return std::nullopt;
  return std::max(kCoarser * request.spacing, kFinest);
}

/// Copies a region from the pixels of `written`, which contains it, to the image of `window`.
void copy_region(const Region& region, const Region& written, std::span<const std::byte> from, size_t bytes_per_pixel,
                 const Region& window, picture::Image& image) {
  const size_t row = static_cast<size_t>(region.width) * bytes_per_pixel;
  const auto place = [&](int x, int y, int width) {
    return (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)) * bytes_per_pixel;
  };
  for (int y = region.y; y < region.y + region.height; ++y) {
    std::memcpy(image.pixels.data() + place(region.x - window.x, y - window.y, image.width),
                from.data() + place(region.x - written.x, y - written.y, written.width), row);
  }
}

/// The number of blocks by level, finest first.
std::vector<picture::LevelStats> level_stats(const ldc::BlockTree& tree, const selection::BlockSelection& selection) {
  std::map<int, picture::LevelStats> levels;
  for (const uint32_t block : selection.target) ++levels[tree.blocks()[block].level].selected;
  for (const uint32_t block : selection.draw) ++levels[tree.blocks()[block].level].drawn;
  std::vector<picture::LevelStats> stats;
  stats.reserve(levels.size());
  for (auto& [level, counts] : levels) stats.push_back({level, counts.selected, counts.drawn});
  return stats;
}

selection::Window window_of(const Region& region) {
  return {static_cast<double>(region.x), static_cast<double>(region.y), static_cast<double>(region.x + region.width),
          static_cast<double>(region.y + region.height)};
}

/// Whether a block is drawn in place of finer ones: of which too little is seen, or which are still to come.
bool stands_in(const ldc::BlockTree& tree, uint32_t block, const geometry::CameraFrame& frame, double spacing) {
  constexpr double kCoarser = 2;
  return tree.children(block).count > 0 &&
         selection::projected_spacing(tree.blocks()[block], frame) > kCoarser * spacing;
}

/// A hash of the drawn blocks, never 0.
uint64_t cut_of(const selection::BlockSelection& selection) {
  return hash_of(std::as_bytes(std::span(selection.draw))) | 1;
}

/// A picture, or a window of it, that is being drawn.
struct Part {
  Scene& scene;
  const picture::PictureRequest& request;
  const DisplayOptions& display;
  geometry::Camera camera;
  geometry::CameraFrame frame;
  std::optional<Region> window;
  const Preemption& preemption;

  [[nodiscard]] Region region() const { return window.value_or(Region{0, 0, request.width, request.height}); }
  [[nodiscard]] ShownPart shown() const {
    return {frame, request.spacing, request.clip, request.hidden_classes, request.hidden_models};
  }
  /// Whether it shows opaque surfaces alone, to a spacing: such pictures may be surveyed.
  [[nodiscard]] bool may_hide_blocks() const {
    return scene.has_surfaces() && !scene.mixed() && !display.through.any && !window &&
           request.filter == picture::Filter::kEwa && !picture::has_budget(request) &&
           request.rest_spacing.value_or(request.spacing) > 0;
  }
  [[nodiscard]] bool is_at_rest() const {
    return request.viewer == 0 && request.normalization == picture::Normalization::kPixel;
  }
};

/// Adds what the preparation of the survey took.
void add_costs(const residency::PreparedView& survey, residency::PreparedView& view) {
  view.waited_for += survey.waited_for;
  view.select_ms += survey.select_ms;
  view.load_ms += survey.load_ms;
  view.decode_ms += survey.decode_ms;
  view.upload_ms += survey.upload_ms;
}

/// True if a view differs from the picture that the client displays, and few enough blocks are missing.
bool worth_drawing(const picture::PictureRequest& request, const residency::PreparedView& view, uint64_t cut) {
  if (request.displayed_cut != 0 && cut == request.displayed_cut) return false;
  return view.nothing_pending || view.missing <= request.max_missing_blocks;
}

/// Needs the current GL context. The pool is no larger than a buffer texture of splats, which take two texels each.
MemoryBudgets budgets_of(const RendererConfig& config, bool software) {
  const MemoryBudgets by_default =
      default_budgets({read_host_memory().available / config.sharers, software ? std::nullopt : gl::free_gpu_memory()});
  const uint64_t wanted = config.gpu_bytes.value_or(by_default.gpu);
  const uint64_t possible = residency::BlockMemory::device_limit() / 2 * sizeof(glm::uvec4);
  return {std::min(wanted, possible), config.host_bytes.value_or(by_default.host)};
}

}  // namespace

struct Renderer::State {
  State(const RendererConfig& config, std::unique_ptr<gl::EglContext> egl, Programs passes)
      : context(std::move(egl)),
        device{context->vendor(), context->renderer(), context->version(), context->software(),
               budgets_of(config, context->software())},
        programs(std::move(passes)),
        kinds(config.kinds),
        motion_glyphs(config.motion_glyphs),
        viewers(config.viewers),
        surveys(config.surveys),
        list_entries(std::min(config.list_entries.value_or(residency::BlockMemory::device_limit()),
                              residency::BlockMemory::device_limit())),
        surfels(device.memory.gpu / sizeof(glm::uvec4), device.software),
        residency(surfels, limits_of(config, device.memory), config.load_guard) {
    for (SplatBuffers& set : buffers) {
      set.srgb = ConstantTexels::make("linear roots of sRGB", residency::linear_root_table());
      set.lazy = device.software && gl::can_adopt_memory();
    }
  }

  static residency::ResidencyLimits limits_of(const RendererConfig& config, const MemoryBudgets& memory) {
    // Enough to keep the uploads busy; more would only hold memory. A quarter of a small budget.
    const size_t ready = std::clamp<size_t>(memory.host / 4, size_t{16} << 20, size_t{64} << 20);
    const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
    const unsigned threads = config.decoders > 0 ? config.decoders : cores;
    return {.pages = static_cast<uint32_t>(memory.gpu / sizeof(glm::uvec4) / residency::BlockPool::kPageTexels),
            .loader = {threads, threads, memory.host, ready},
            .upload_bytes = config.upload_bytes};
  }

  /// Where searches for the spacing of a model's pictures begin.
  struct Searched {
    SpacingGuess error;
    std::optional<SpacingTime> time;
  };

  /// Marks a picture as being drawn during the lifetime of the object.
  struct PictureScope {
    explicit PictureScope(State& owner) : state(owner) { state.begin_picture(); }
    ~PictureScope() { state.end_picture(); }
    PictureScope(const PictureScope&) = delete;
    PictureScope& operator=(const PictureScope&) = delete;
    State& state;
  };
  void begin_picture();
  void end_picture();
  void release_models();
  Result<Scene*> scene_of(const std::shared_ptr<const model::ModelFile>& model);
  Result<residency::PreparedView> prepare(const Part& part);
  Result<RegionStats> draw_regions(const Part& part, const residency::PreparedView& view,
                                   selection::VisibleDepths* shown, picture::Frame& result);
  Result<RegionStats> draw_survey(const Part& part, residency::PreparedView& view, picture::Frame& result);
  const ConstantTexels* colors_of(const DisplayOptions& display);
  [[nodiscard]] picture::FrameStats stats_of(const Scene& scene, const residency::PreparedView& view,
                                             const RegionStats& drawn) const;
  Result<picture::Frame> draw_whole(const std::shared_ptr<const model::ModelFile>& model,
                                    const picture::PictureRequest& request, const Preemption& preemption);
  Result<picture::Frame> draw_part(const std::shared_ptr<const model::ModelFile>& model,
                                   const picture::PictureRequest& request, const std::optional<Region>& window,
                                   const Preemption& preemption);
  Result<picture::Frame> draw(const std::shared_ptr<const model::ModelFile>& model,
                              const picture::PictureRequest& request, const Preemption& preemption);

  std::unique_ptr<gl::EglContext> context;
  picture::DeviceInfo device;
  Programs programs;
  kinds::KindTable kinds;
  std::array<SplatBuffers, 3> buffers;  ///< of the picture being drawn, and of those that preempt it
  size_t depth = 0;                     ///< pictures being drawn: more than 1 while one preempts another
  std::map<std::pair<picture::SurfelColor, picture::ColorMap>, ConstantTexels>
      color_tables;        ///< made at their first use
  uint32_t motion_glyphs;  ///< see RendererConfig
  size_t viewers;          ///< see RendererConfig
  bool surveys;            ///< see RendererConfig
  size_t list_entries;     ///< of all tile lists of a region
  residency::BlockMemory surfels;
  residency::Residency residency;
  std::map<uint64_t, std::unique_ptr<Scene>> scenes;  ///< by ModelFile::id
  std::map<uint64_t, Searched> searched;              ///< likewise
  std::vector<uint64_t> to_release;                   ///< models to release once no picture is being drawn
};

void Renderer::State::begin_picture() {
  SURFCAST_EXPECTS(depth < buffers.size());
  if (++depth > 1) residency.begin_nested_frame();
}

void Renderer::State::end_picture() {
  if (--depth == 0) return release_models();
  residency.end_nested_frame();
}

void Renderer::State::release_models() {
  for (const uint64_t id : std::exchange(to_release, {})) {
    residency.release_model(id);
    scenes.erase(id);
    searched.erase(id);
  }
}

Result<Scene*> Renderer::State::scene_of(const std::shared_ptr<const model::ModelFile>& model) {
  if (const auto found = scenes.find(model->id()); found != scenes.end()) return found->second.get();
  Result<std::unique_ptr<Scene>> scene = Scene::create(model, kinds);
  if (!scene) return fail(scene);
  return scenes.emplace(model->id(), std::move(*scene)).first->second.get();
}

/// Prepares the picture, or the survey that it needs first.
Result<residency::PreparedView> Renderer::State::prepare(const Part& part) {
  Scene& scene = part.scene;
  const picture::PictureRequest& request = part.request;
  const DisplayOptions& display = part.display;
  const std::vector<bool> clear = clear_blocks(scene.model(), display.volumes);
  const std::vector<bool> hidden_members = model::hidden_members(scene.model(), request.hidden_models);
  std::vector<uint32_t> roots;  // where members are hidden
  if (!hidden_members.empty()) roots = model::shown_roots(scene.model(), hidden_members);
  residency::ViewParameters parameters{part.frame,
                                       request.spacing,
                                       display.clipped ? &request.clip : nullptr,
                                       display.attributes,
                                       request.viewer != 0,
                                       clear.empty() ? nullptr : &clear,
                                       request.rest_spacing,
                                       sides_of(display),
                                       ghost_spacing(display, request),
                                       display.glyph_reaches.empty() ? nullptr : &display.glyph_reaches};
  if (part.window) parameters.window = window_of(*part.window);
  if (!hidden_members.empty()) parameters.roots = &roots;
  if (request.rest_spacing && scene.has_glyphs()) {
    parameters.items = &scene.glyphs();
    parameters.most_items = most_glyphs(request, motion_glyphs);
  }
  Surveys::Found visible;  // lives as long as the preparation, in which another picture may be drawn
  if (surveys && part.may_hide_blocks()) {
    if (part.is_at_rest()) visible = scene.surveys().find(part.shown());
    // In motion, what a picture at rest from there has found: where a view begins, or where it comes back to.
    if (request.viewer != 0) visible = scene.surveys().find_from_camera(part.shown());
    const double spacing = request.rest_spacing.value_or(request.spacing);
    parameters.visible = visible.get();
    if (!visible && (part.is_at_rest() || request.rest_spacing)) {
      const double worth = surfels_worth_a_survey(request.width, request.height, spacing);
      parameters.survey = {request.surveyed ? 0 : worth, survey_spacing(spacing)};
    }
  }
  if (request.loading == picture::Loading::kWait)
    return residency.prepare_complete(scene.viewed(), parameters, part.preemption);
  if (request.viewer == 0) return residency.prepare_resident(scene.viewed(), parameters, {}, {});
  ViewerHistory& history = scene.history_of(request.viewer, viewers);
  const std::optional<geometry::CameraFrame> ahead =
      update_and_extrapolate(history, part.camera, request.width, request.height);
  residency::PreparedView view = residency.prepare_resident(scene.viewed(), parameters, history.refined, ahead);
  history.refined = view.selection.refined;
  return view;
}

const ConstantTexels* Renderer::State::colors_of(const DisplayOptions& display) {
  if (!display.mapped()) return nullptr;
  const auto key = std::pair(display.color, display.map);
  const auto found = color_tables.find(key);
  if (found != color_tables.end()) return &found->second;
  return &color_tables.emplace(key, ConstantTexels::make("colours", color_table(display))).first->second;
}

/// `shown`: the depths that the picture shows are entered there, unless it is null.
Result<RegionStats> Renderer::State::draw_regions(const Part& part, const residency::PreparedView& view,
                                                  selection::VisibleDepths* shown, picture::Frame& result) {
  const Scene& scene = part.scene;
  const picture::PictureRequest& request = part.request;
  const DisplayOptions& display = part.display;
  const geometry::CameraFrame& frame = part.frame;
  const Region window = part.region();
  Variant variant = variant_of(scene.model().info(), display, request);
  if (!scene.has_surfaces()) variant.eye_dome = variant.silhouettes = false;
  if (scene.has_gaussians() || scene.has_glyphs()) variant.eye_dome = false;
  // Harmonics of higher degrees cost as much as all else of a projection, and change little from picture to picture.
  if (request.rest_spacing) variant.harmonics = 1;
  variant.depth = request.depth_texels > 0 && !variant.density;  // a medium has no surfaces
  if (variant.depth) result.depth = picture::empty_depth_map(request.width, request.height, request.depth_texels);
  result.depth.seen_through = variant.depth && (variant.transparent || !scene.model().volumes().empty());
  // A picture that will soon be redrawn does not need supersampling.
  const bool to_be_redrawn = !view.nothing_pending || view.survey;
  variant.silhouettes &= !to_be_redrawn;
  variant.shown_depths = shown != nullptr;
  const bool layered = scene.mixed() || scene.has_glyphs();  // many buffers for every pixel
  const int margin = variant.eye_dome || variant.silhouettes || scene.mixed() ? kNeighbourMargin : 0;
  const size_t bytes = pixel_bytes(request.format);
  const model::ModelInfo& info = scene.model().info();
  RegionStats total;
  std::vector<std::byte> pixels;
  std::vector<Region> regions =
      cut_into_regions(window.width, window.height, margin, layered ? kMaxLayeredSide : kMaxRegionSide);
  while (!regions.empty()) {
    const Region at = regions.back();
    const Region region{at.x + window.x, at.y + window.y, at.width, at.height};
    regions.pop_back();
    const Region drawn = with_margin(region, margin, request.width, request.height);
    RegionTask task{&surfels,
                    kinds,
                    {},
                    frame,
                    region,
                    drawn,
                    frame_constants(frame, drawn, request, {scene.has_fronts() && !variant.transparent, info.even}),
                    variant,
                    &request,
                    display,
                    colors_of(display),
                    list_entries,
                    variant.depth ? &result.depth : nullptr,
                    shown,
                    scene.has_gaussians()};
    for (const uint32_t block :
         selection::blocks_in_rectangle(scene.viewed().tree, view.selection.draw, frame, drawn.x, drawn.y,
                                        drawn.x + drawn.width, drawn.y + drawn.height, sides_of(display),
                                        display.glyph_reaches.empty() ? nullptr : &display.glyph_reaches)) {
      const ldc::BlockTree& tree = scene.model().tree();
      const geometry::Box& bounds = tree.blocks()[block].bounds;
      const bool replaces = !view.selection.budget_reached && stands_in(tree, block, frame, request.spacing);
      const bool coarse = replaces || to_be_redrawn;
      task.blocks.push_back({&residency.pool().at({scene.model().id(), block}),
                             selection::radii_at_spacing(bounds, frame, request.spacing), scene.first_surfel(block),
                             scene.kind_of(block), coarse});
    }
    const Region& written = variant.eye_dome ? region : drawn;
    pixels.resize(static_cast<size_t>(written.width) * static_cast<size_t>(written.height) * bytes);
    const Result<std::optional<RegionStats>> stats =
        compose_region(task, programs, buffers[depth - 1], part.preemption, pixels);
    if (!stats) return fail(stats);
    if (!*stats) {
      const std::vector<Region> halves = halves_of(at);
      if (halves.empty()) return fail(ErrorKind::kLimit, "too many surfels in four by four pixels");
      regions.insert(regions.end(), halves.begin(), halves.end());
      continue;
    }
    copy_region(region, written, pixels, bytes, window, result.image);
    total += **stats;
  }
  return total;
}

picture::FrameStats Renderer::State::stats_of(const Scene& scene, const residency::PreparedView& view,
                                              const RegionStats& drawn) const {
  picture::FrameStats stats;
  stats.surfels_drawn = drawn.splats;
  stats.blocks_drawn = static_cast<uint32_t>(view.selection.draw.size());
  stats.blocks_selected = static_cast<uint32_t>(view.selection.target.size());
  stats.holes = view.selection.holes;
  stats.blocks_waited_for = view.waited_for;
  stats.blocks_missing = view.missing;
  stats.blocks_resident = static_cast<uint32_t>(residency.pool().blocks());
  stats.bytes_resident = residency.pool().bytes();
  stats.levels = level_stats(scene.model().tree(), view.selection);
  stats.gl_renderer = device.renderer;
  stats.stages = {{"select", view.select_ms}, {"load", view.load_ms},        {"decode", view.decode_ms},
                  {"upload", view.upload_ms}, {"project", drawn.project_ms}, {"bin", drawn.bin_ms},
                  {"splat", drawn.splat_ms},  {"read", drawn.read_ms}};
  return stats;
}

/// Draws the survey of a picture, and prepares the picture, which `view` becomes unless it has to wait for blocks: then
/// the survey is what is there to be shown.
Result<RegionStats> Renderer::State::draw_survey(const Part& part, residency::PreparedView& view,
                                                 picture::Frame& result) {
  const picture::PictureRequest& request = part.request;
  const size_t pixels = static_cast<size_t>(request.width) * static_cast<size_t>(request.height);
  result.image.pixels.resize(pixels * pixel_bytes(request.format));
  const double spacing = survey_spacing(request.spacing);
  selection::VisibleDepths depths(request.width, request.height, spacing);
  Result<RegionStats> drawn = draw_regions(part, view, &depths, result);
  if (!drawn) return drawn;
  const auto visible = std::make_shared<selection::Visibility>(std::move(depths), part.frame, spacing);
  for (const uint32_t block : view.selection.draw) {
    const auto packed = residency.packed(part.scene.viewed(), block, part.display.attributes);
    if (!packed) return fail(packed);
    const residency::BlockHeader& header = *(**packed).header;
    visible->enter(block, header.centres(**packed), [&](size_t i) { return header.centre(**packed, i); });
  }
  part.scene.surveys().keep(part.shown(), visible);
  Result<residency::PreparedView> next = prepare(part);
  if (!next) return fail(next);
  if (next->missing > 0) {
    view.missing = next->missing;
    return drawn;
  }
  add_costs(view, *next);
  view = std::move(*next);
  result.image.pixels.clear();
  return drawn;
}

/// Draws a picture, or a window of it, whose pixels are those of the whole picture.
Result<picture::Frame> Renderer::State::draw_part(const std::shared_ptr<const model::ModelFile>& model,
                                                  const picture::PictureRequest& request,
                                                  const std::optional<Region>& window, const Preemption& preemption) {
  Result<DisplayOptions> display = resolve_display_options(model->info(), request);
  if (!display) return fail(display);
  if (display->volumes.points.empty() && !model->volumes().empty()) {
    display->volumes.points = preset_points(request.volumes.transfer, model->volumes().front());
  }
  if (Status status = resolve_glyphs(model->ellipsoid_sources(), request, *display); !status) {
    return fail(status);
  }
  display->glyph_reaches = glyph_reaches(*model, request.glyphs);
  const Result<Scene*> found = scene_of(model);
  if (!found) return fail(found);
  Scene& scene = **found;
  picture::Frame result;
  result.camera = scene.camera_of(request);
  const Result<geometry::CameraFrame> frame = geometry::make_camera_frame(result.camera, request.width, request.height);
  if (!frame) return fail(frame);
  const Part part{scene, request, *display, result.camera, *frame, window, preemption};
  Result<residency::PreparedView> view = prepare(part);
  if (!view) return fail(view);
  const Region region = part.region();
  const size_t pixels = static_cast<size_t>(region.width) * static_cast<size_t>(region.height);
  result.image = {region.width, region.height, request.format, {}};
  RegionStats drawn;
  bool surveyed = false;
  if (view->survey && view->missing == 0) {
    const Result<RegionStats> survey = draw_survey(part, *view, result);
    if (!survey) return fail(survey);
    drawn = *survey;
    surveyed = view->survey;
  }

  result.converged = view->selection.converged() && !view->survey;
  result.nothing_pending = view->nothing_pending && !view->survey;
  result.cut = cut_of(view->selection);
  if (!surveyed && worth_drawing(request, *view, result.cut)) {
    result.image.pixels.resize(pixels * pixel_bytes(request.format));
    const Result<RegionStats> regions = draw_regions(part, *view, nullptr, result);
    if (!regions) return fail(regions);
    drawn += *regions;
    drawn.splats = regions->splats;
  }
  result.stats = stats_of(scene, *view, drawn);
  result.spacing = request.spacing;
  return result;
}

/// Draws a whole picture at its render scale.
Result<picture::Frame> Renderer::State::draw_whole(const std::shared_ptr<const model::ModelFile>& model,
                                                   const picture::PictureRequest& request,
                                                   const Preemption& preemption) {
  if (request.render_scale == 1) return draw_part(model, request, {}, preemption);
  const picture::PictureRequest smaller = at_render_scale(request);
  Result<picture::Frame> frame = draw_part(model, smaller, {}, preemption);
  if (!frame) return frame;
  const Stopwatch watch;
  frame->image = enlarge(frame->image, request.width, request.height);
  if (frame->depth.cell > 0) {
    picture::DepthMap map = picture::empty_depth_map(request.width, request.height, request.depth_texels);
    enlarge_depth(frame->depth, {smaller.width, smaller.height}, {request.width, request.height}, map);
    frame->depth = std::move(map);
  }
  frame->spacing = request.spacing;
  frame->render_scale = request.render_scale;
  frame->stats.stages.push_back({"enlarge", watch.milliseconds()});
  return frame;
}

Result<picture::Frame> Renderer::State::draw(const std::shared_ptr<const model::ModelFile>& model,
                                             const picture::PictureRequest& request, const Preemption& preemption) {
  if (request.width < 1 || request.height < 1 || request.width > kMaxResolution || request.height > kMaxResolution) {
    return fail(ErrorKind::kLimit, "resolution: each side must lie between 1 and " + std::to_string(kMaxResolution));
  }
  if (!picture::has_budget(request) || request.loading == picture::Loading::kNow) {
    return draw_whole(model, request, preemption);
  }
  if (request.time_ms > 0) {
    const auto draw_picture = [&](const picture::PictureRequest& whole) {
      return draw_whole(model, whole, preemption);
    };
    return draw_to_time(request, draw_picture, searched[model->id()].time);
  }
  const auto draw_window = [&](const picture::PictureRequest& part, const std::optional<Region>& window) {
    return draw_part(model, part, window, preemption);
  };
  return draw_to_error(request, draw_window, searched[model->id()].error);
}

Result<std::unique_ptr<Renderer>> Renderer::create(const RendererConfig& config) {
  Result<std::unique_ptr<gl::EglContext>> context = gl::EglContext::create(config.gpu);
  if (!context) return fail(context);
  const bool software = (*context)->software() && !config.gpu_kernels;
  Result<Programs> programs = Programs::create(software ? software_kernels() : KernelShape(), config.shader_defines);
  if (!programs) return fail(programs);
  return std::unique_ptr<Renderer>(
      new Renderer(std::make_unique<State>(config, std::move(*context), std::move(*programs))));
}

Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Renderer::~Renderer() = default;

const picture::DeviceInfo& Renderer::device() const {
  return state_->device;
}
std::vector<std::string> Renderer::programs() const {
  return state_->programs.compiled();
}
int Renderer::max_resolution() const {
  return kMaxResolution;
}
void Renderer::release_model(const model::ModelFile& model) {
  state_->to_release.push_back(model.id());
  if (state_->depth == 0) state_->release_models();
}

Result<picture::Frame> Renderer::draw(const std::shared_ptr<const model::ModelFile>& model,
                                      const picture::PictureRequest& request, const Preemption& preemption) {
  const State::PictureScope scope(*state_);
  return state_->draw(model, request, preemption);
}

}  // namespace surfcast::render
