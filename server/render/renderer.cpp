#include "render/renderer.h"

#include <algorithm>
#include <cstring>

#include "base/contract.h"
#include "base/stopwatch.h"
#include "gl/egl_context.h"
#include "render/programs.h"
#include "render/region_passes.h"
#include "render/splat_buffers.h"
#include "residency/resident_set.h"
#include "selection/select_blocks.h"

namespace surfcast {
namespace {

constexpr size_t kGpuBudgetBytes = size_t{4} << 30;
constexpr int kMaxResolution = 16384;
constexpr double kViewAngle = 30;  // degrees, of the view that is chosen when none is asked for

size_t pixel_bytes(PixelFormat format) {
  return format == PixelFormat::kSrgb8 ? 4 : 4 * sizeof(float);
}

Variant variant_of(const ModelInfo& info, const PictureRequest& request) {
  Variant variant;
  variant.colored = info.color_bits > 0;
  variant.lit = request.shading == Shading::kLit || (request.shading == Shading::kAuto && !variant.colored);
  variant.float_picture = request.format == PixelFormat::kLinearFloat;
  return variant;
}

/// Mean normal of the whole model, from the cones of its leaves; zero where front and back are not known.
glm::dvec3 mean_facing(const ModelFile& model) {
  glm::dvec3 sum(0);
  for (const BlockEntry& block : model.blocks()) {
    if (block.level == 0 && block.normals) sum += glm::dvec3(block.normals->axis) * static_cast<double>(block.surfels);
  }
  return sum / static_cast<double>(std::max<uint64_t>(model.info().surfels, 1));
}

Camera camera_of(const ModelFile& model, const PictureRequest& request) {
  if (request.camera) return *request.camera;
  const glm::dvec3 up = model.info().z_up ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  Box box = model.info().bounds;
  double reach = 0;
  for (const BlockEntry& block : model.blocks()) {
    if (block.level == 0) reach = std::max(reach, block.max_radius);
  }
  box.min -= reach;
  box.max += reach;
  return fit_camera(box, up, static_cast<double>(request.width) / request.height, kViewAngle, mean_facing(model));
}

void copy_region(const Region& region, std::span<const std::byte> from, size_t bytes_per_pixel, Image& image) {
  const size_t row = static_cast<size_t>(region.width) * bytes_per_pixel;
  for (int y = 0; y < region.height; ++y) {
    const size_t target =
        (static_cast<size_t>(region.y + y) * static_cast<size_t>(image.width) + static_cast<size_t>(region.x)) *
        bytes_per_pixel;
    std::memcpy(image.pixels.data() + target, from.data() + static_cast<size_t>(y) * row, row);
  }
}

}  // namespace

struct Renderer::State {
  std::unique_ptr<EglContext> context;
  DeviceInfo device;
  Programs programs;
  SplatBuffers buffers;
  ResidentSet residents{kGpuBudgetBytes};
};

Result<std::unique_ptr<Renderer>> Renderer::create(const RendererConfig& config) {
  Result<std::unique_ptr<EglContext>> context = EglContext::create(config.gpu);
  if (!context) return fail(std::move(context.error()));
  const int rows = (*context)->software() ? 4 : 1;  // see include/rows.glsl
  Result<Programs> programs = Programs::create(rows);
  if (!programs) return fail(std::move(programs.error()));
  auto state = std::make_unique<State>();
  state->device = {(*context)->vendor(), (*context)->renderer(), (*context)->version(), (*context)->software()};
  state->context = std::move(*context);
  state->programs = std::move(*programs);
  return std::unique_ptr<Renderer>(new Renderer(std::move(state)));
}

Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Renderer::~Renderer() = default;

const DeviceInfo& Renderer::device() const {
  return state_->device;
}
int Renderer::max_resolution() const {
  return kMaxResolution;
}
void Renderer::forget(const ModelFile& model) {
  state_->residents.forget(model);
}

Result<Frame> Renderer::draw(const ModelFile& model, const PictureRequest& request,
                             const std::atomic<bool>& cancelled) {
  if (request.width < 1 || request.height < 1 || request.width > kMaxResolution || request.height > kMaxResolution) {
    return fail(ErrorKind::kLimit, "resolution: each side must lie between 1 and " + std::to_string(kMaxResolution));
  }
  Frame result;
  result.camera = camera_of(model, request);
  Result<CameraFrame> frame = make_camera_frame(result.camera, request.width, request.height);
  if (!frame) return fail(std::move(frame.error()));

  const Stopwatch load_watch;
  Result<const ResidentModel*> resident = state_->residents.require(model);
  if (!resident) return fail(std::move(resident.error()));
  const double load_ms = load_watch.milliseconds();

  const size_t bytes = pixel_bytes(request.format);
  result.image = {request.width, request.height, request.format, {}};
  result.image.pixels.resize(static_cast<size_t>(request.width) * static_cast<size_t>(request.height) * bytes);
  RegionStats total;
  double select_ms = 0;
  const Stopwatch cut_watch;
  const SelectionTree tree(model.tree());
  const std::vector<bool> all_resident(model.blocks().size(), true);
  const BlockSelection selection = select_blocks(tree, *frame, {.spacing = request.spacing}, all_resident);
  select_ms += cut_watch.milliseconds();
  std::vector<std::byte> pixels;
  for (const Region& region : cut_into_regions(request.width, request.height)) {
    const Stopwatch select_watch;
    RegionTask task{*resident,
                    blocks_in_rectangle(tree, selection.draw, *frame, region.x, region.y, region.x + region.width,
                                        region.y + region.height),
                    *frame,
                    region,
                    frame_constants(*frame, region, request, model.info().oriented),
                    variant_of(model.info(), request)};
    select_ms += select_watch.milliseconds();
    pixels.resize(static_cast<size_t>(region.width) * static_cast<size_t>(region.height) * bytes);
    Result<RegionStats> stats = draw_region(task, state_->programs, state_->buffers, cancelled, pixels);
    if (!stats) return fail(std::move(stats.error()));
    copy_region(region, pixels, bytes, result.image);
    total.splats += stats->splats;
    total.project_ms += stats->project_ms;
    total.bin_ms += stats->bin_ms;
    total.splat_ms += stats->splat_ms;
    total.read_ms += stats->read_ms;
  }
  result.stats.surfels_drawn = total.splats;
  result.stats.blocks_drawn = static_cast<uint32_t>(selection.draw.size());
  result.stats.gl_renderer = state_->device.renderer;
  result.stats.stages = {{"load", load_ms},     {"select", select_ms},     {"project", total.project_ms},
                         {"bin", total.bin_ms}, {"splat", total.splat_ms}, {"read", total.read_ms}};
  return result;
}

}  // namespace surfcast
