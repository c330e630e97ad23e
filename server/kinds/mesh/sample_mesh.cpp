#include "mesh/sample_mesh.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <spdlog/fmt/fmt.h>

#include "mesh/chart_map.h"
#include "mesh/mesh_edges.h"
#include "mesh/opacity_map.h"
#include "mesh/patch_plan.h"
#include "mesh/texel_color.h"
#include "mesh/texture.h"
#include "surfel/srgb.h"

namespace surfcast::mesh {
namespace {

/// Spacing of surfaces without texture, as a share of the diagonal. It is larger where it would make more surfels than
/// those of a mesh and those of a triangle: few triangles have no details.
constexpr double kUsualSpacing = 1.0 / 1500;
constexpr double kUsualSurfels = 1 << 17;
constexpr double kUsualSurfelsOfTriangle = 1 << 10;
/// sRGB, the grey in which models without colours are drawn (kGrey of shaders/include/resolve.glsl).
constexpr uint8_t kGrey = 231;
/// Surfels that are made together, and those of one task.
constexpr double kBatch = 1 << 19;
constexpr double kTask = 1 << 14;

/// A patch, and how it is sampled.
struct PatchWork {
  const Patch* patch = nullptr;
  PatchFacts facts;
  PatchPlan plan;
};

/// The patches of a material.
struct MaterialWork {
  const Material* material = nullptr;
  std::vector<PatchWork> patches;
};

/// Rows of cells of a triangle.
struct Task {
  const PatchWork* work = nullptr;
  size_t patch = 0;  ///< of the material
  size_t triangle = 0;
  int64_t first_row = 0;
  int64_t end_row = 0;
};

struct Made {
  std::vector<MeshSurfel> surfels;
  uint64_t masked = 0;
  double widest = 0;
};

/// What all triangles of a material share.
struct MaterialColors {
  const Material& material;
  glm::vec4 factor{1};  ///< linear light and alpha
  const Texture* texture = nullptr;
  const ChartMap* charts = nullptr;

  [[nodiscard]] bool opaque() const { return material.alpha == AlphaMode::kOpaque; }
};

template <typename Value>
Value blend(const std::array<Value, 3>& corners, const glm::dvec3& weights) {
  using Scalar = typename Value::value_type;
  return static_cast<Scalar>(weights.x) * corners[0] + static_cast<Scalar>(weights.y) * corners[1] +
         static_cast<Scalar>(weights.z) * corners[2];
}

/// Makes the surfels of a triangle.
class TriangleSampler {
 public:
  TriangleSampler(const MaterialColors& colors, const MeshEdges& edges, const PatchWork& work, const Triangle& triangle,
                  uint32_t chart)
      : colors_(colors), chart_(chart), placed_(place(*work.patch, triangle, edges.inside_out())) {
    if (colors.texture != nullptr) texels_ = texel_corners(*work.patch->vertices, triangle, colors.texture->size());
    plane_ = cells_of(placed_, texels_, work.plan);
    steps_ = CellSteps::of(plane_.cells, placed_.positions);
    radius_ = steps_.radius();
    open_ = edges.open(placed_.positions);
  }

  [[nodiscard]] CellTriangle cells() const { return CellTriangle(plane_.cells); }

  void make(int64_t first, int64_t end, Made& made) const {
    if (!(radius_ > 0 && std::isfinite(radius_))) return;
    made.widest = std::max({made.widest, glm::length(steps_.u), glm::length(steps_.v)});
    cells().for_each_cell(first, end, [&](int64_t i, int64_t j, const glm::dvec3& weights) {
      const glm::vec4 light = light_at(i, j, weights);
      const float least = colors_.material.alpha == AlphaMode::kMask ? colors_.material.cutoff : 0.0F;
      if (light.a < least || light.a == 0) {
        ++made.masked;
      } else {
        made.surfels.push_back(surfel_at(weights, light));
      }
    });
  }

 private:
  [[nodiscard]] MeshSurfel surfel_at(const glm::dvec3& weights, const glm::vec4& light) const;
  [[nodiscard]] glm::vec4 light_at(int64_t i, int64_t j, const glm::dvec3& weights) const;
  [[nodiscard]] glm::vec4 texture_at(int64_t i, int64_t j, const glm::dvec3& weights) const;
  [[nodiscard]] double radius_at(const glm::dvec3& position) const;

  const MaterialColors& colors_;
  uint32_t chart_;
  PlacedTriangle placed_;
  std::optional<std::array<glm::dvec2, 3>> texels_;
  CellPlane plane_;
  CellSteps steps_;
  double radius_ = 0;
  std::array<bool, 3> open_{};
};

/// Kernels of whole radius would end half a cell beyond the border of the surface. Much smaller ones would lose the
/// weight that cells have from afar, where each counts with the square of its radius: docs/textured-models.md has
/// measurements.
double TriangleSampler::radius_at(const glm::dvec3& position) const {
  constexpr double kBeyond = 0.4;  // of the radius
  constexpr double kMin = 0.85;
  double radius = radius_;
  for (size_t k = 0; k < 3; ++k) {
    if (!open_[k]) continue;
    const glm::dvec3& from = placed_.positions[k];
    const glm::dvec3 along = placed_.positions[(k + 1) % 3] - from;
    const double length = glm::length(along);
    if (!(length > 0)) continue;
    const double distance = glm::length(glm::cross(position - from, along)) / length;
    radius = std::min(radius, std::max(distance + kBeyond * radius_, kMin * radius_));
  }
  return radius;
}

glm::vec4 TriangleSampler::texture_at(int64_t i, int64_t j, const glm::dvec3& weights) const {
  const Texture& texture = *colors_.texture;
  const std::array<Wrap, 2>& wrap = colors_.material.wrap;
  const glm::dvec2 size = plane_.texels_per_cell;
  if (size == glm::dvec2(1)) {
    return texel_light(texture, wrapped(i, texture.width, wrap[0]), wrapped(j, texture.height, wrap[1]),
                       colors_.opaque());
  }
  const bool of_texture = size.x > 0;
  const TexelArea area{of_texture ? glm::dvec2(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5) * size
                                  : blend(*texels_, weights),
                       of_texture ? size : glm::dvec2(0)};
  return mean_light(texture, area, wrap, colors_.opaque(), colors_.charts, chart_);
}

/// Linear light and opacity.
glm::vec4 TriangleSampler::light_at(int64_t i, int64_t j, const glm::dvec3& weights) const {
  glm::vec4 light = colors_.factor;
  if (placed_.colors) light *= blend(*placed_.colors, weights);
  if (texels_) light *= texture_at(i, j, weights);
  if (colors_.opaque()) light.a = 1;
  return light;
}

MeshSurfel TriangleSampler::surfel_at(const glm::dvec3& weights, const glm::vec4& light) const {
  MeshSurfel surfel;
  surfel.position = blend(placed_.positions, weights);
  const glm::dvec3 normal = blend(placed_.normals, weights);
  const double length = glm::length(normal);
  surfel.normal = glm::vec3(length > 0 ? normal / length : placed_.normals[0]);
  surfel.radius = static_cast<float>(radius_at(surfel.position));
  surfel.color = glm::u8vec3(surfel::from_linear(glm::vec3(light), 8));
  const bool blends = colors_.material.alpha == AlphaMode::kBlend;
  surfel.alpha = blends ? static_cast<uint8_t>(std::max(std::lround(std::min(light.a, 1.0F) * 255.0F), 1L)) : 255;
  return surfel;
}

/// Samples a mesh material by material.
class MeshPass {
 public:
  MeshPass(const Mesh& mesh, const SampleOptions& options, const scan::DecodingLimit& limit, const TexelSink& sink)
      : mesh_(mesh), options_(options), limit_(limit), sink_(sink), bounds_(mesh.bounds()), edges_(mesh, bounds_) {}

  Result<MeshReport> run();

 private:
  /// The last image of a kind that was decoded.
  struct HeldImage {
    size_t image = SIZE_MAX;
    Texture texture;
  };

  const Texture* decoded(size_t image, HeldImage& held);
  MaterialImages images_of(const Material& material);
  Status find_work();
  [[nodiscard]] double usual_spacing() const;
  void plan_work();
  void limit_surfels();
  Status sample(const MaterialWork& work);
  Status flush(const MaterialColors& colors, std::vector<Task>& tasks);
  [[nodiscard]] uint32_t chart_of(const MaterialColors& colors, size_t patch, size_t triangle) const {
    return colors.charts == nullptr ? 0 : colors.charts->chart(patch, triangle);
  }

  const Mesh& mesh_;
  const SampleOptions& options_;
  const scan::DecodingLimit& limit_;
  const TexelSink& sink_;
  geometry::Box bounds_;
  MeshEdges edges_;
  std::vector<MaterialWork> work_;
  std::map<size_t, Error> missing_;  ///< images, and why
  HeldImage color_;
  HeldImage opacity_;
  MeshReport report_;
};

/// The last image is kept: patches of one image follow each other.
const Texture* MeshPass::decoded(size_t image, HeldImage& held) {
  if (missing_.contains(image)) return nullptr;
  if (held.image == image) return &held.texture;
  held = {};
  const ImageSource& source = mesh_.images[image];
  Result<Texture> texture = read_texture(source, limit_);
  if (!texture) {
    missing_.emplace(image, Error{texture.error().kind, source.name + " " + texture.error().message});
    return nullptr;
  }
  held = {image, std::move(*texture)};
  return &held.texture;
}

/// Bytes of a texture and of the map of its charts.
uint64_t texture_bytes(const glm::ivec2& size) {
  return 8 * static_cast<uint64_t>(size.x) * static_cast<uint64_t>(size.y);
}

MaterialImages MeshPass::images_of(const Material& material) {
  MaterialImages images;
  if (material.image) images.color = decoded(*material.image, color_);
  if (!material.opacity) {
    opacity_ = {};
    return images;
  }
  const size_t number = material.opacity->image;
  images.opacity = material.image == number ? images.color : decoded(number, opacity_);
  if (images.opacity == nullptr || images.opacity == images.color) return images;
  const uint64_t color_bytes = images.color != nullptr ? texture_bytes(images.color->size()) : 0;
  const Status fits = limit_.check(color_bytes + texture_bytes(images.opacity->size()) + texture_bytes(*images.size()));
  if (fits) return images;
  missing_.emplace(number, Error{fits.error().kind, mesh_.images[number].name + " " + fits.error().message});
  images.opacity = nullptr;
  return images;
}

/// Materials in the order of their images, so that each image is decoded twice at most: to plan, and to sample.
Status MeshPass::find_work() {
  std::map<std::pair<size_t, size_t>, std::vector<const Patch*>> sorted;
  for (const Patch& patch : mesh_.patches) {
    sorted[{mesh_.materials[patch.material].image.value_or(SIZE_MAX), patch.material}].push_back(&patch);
  }
  std::set<size_t> images;
  for (const auto& [key, patches] : sorted) {
    MaterialWork& work = work_.emplace_back();
    const Material& material = mesh_.materials[key.second];
    work.material = &material;
    const std::optional<glm::ivec2> size = images_of(material).size();
    if (material.image) images.insert(*material.image);
    if (material.opacity) images.insert(material.opacity->image);
    for (const Patch* patch : patches) {
      work.patches.push_back({patch, facts_of(*patch, size), {}});
      report_.texels += work.patches.back().facts.texels;
    }
  }
  report_.images = images.size();
  report_.images_missing = missing_.size();
  // More memory would show images that are there: a picture without any of them is not what was asked for.
  if (images.empty() || missing_.size() < images.size()) return {};
  for (const auto& [image, why] : missing_) {
    if (why.kind == ErrorKind::kLimit) return fail(why);
  }
  return {};
}

/// The spacing of surfaces without texture.
double MeshPass::usual_spacing() const {
  double area = 0;
  double triangles = 0;
  for (const MaterialWork& work : work_) {
    for (const PatchWork& patch : work.patches) {
      if (patch.facts.texels > 0) continue;
      area += patch.facts.area;
      triangles += static_cast<double>(patch.facts.triangles);
    }
  }
  const double most = std::max(kUsualSurfels, kUsualSurfelsOfTriangle * triangles);
  return std::max(bounds_.diagonal() * kUsualSpacing, std::sqrt(area / most));
}

void MeshPass::plan_work() {
  const double usual = usual_spacing();
  for (MaterialWork& work : work_) {
    for (PatchWork& patch : work.patches) patch.plan = plan_patch(patch.facts, usual, options_.spacing);
  }
}

void MeshPass::limit_surfels() {
  double total = 0;
  for (const MaterialWork& work : work_) {
    for (const PatchWork& patch : work.patches) total += expected_surfels(patch.facts, patch.plan);
  }
  int doublings = 0;
  while (total > static_cast<double>(options_.most_surfels) * std::exp2(2 * doublings)) ++doublings;
  if (doublings == 0) return;
  report_.notes.push_back(fmt::format("surfels are {} texels apart, so that there are no more than {}",
                                      uint64_t{1} << std::min(doublings, 62), options_.most_surfels));
  for (MaterialWork& work : work_) {
    for (PatchWork& patch : work.patches) {
      patch.plan.texels_per_cell *= std::exp2(doublings);
      patch.plan.spacing *= std::exp2(doublings);
    }
  }
}

Status MeshPass::flush(const MaterialColors& colors, std::vector<Task>& tasks) {
  std::vector<Made> made(tasks.size());
  oneapi::tbb::parallel_for(size_t{0}, tasks.size(), [&](size_t i) {
    const Task& task = tasks[i];
    const Triangle& triangle = (*task.work->patch->triangles)[task.triangle];
    TriangleSampler(colors, edges_, *task.work, triangle, chart_of(colors, task.patch, task.triangle))
        .make(task.first_row, task.end_row, made[i]);
  });
  tasks.clear();
  for (const Made& part : made) {
    report_.surfels += part.surfels.size();
    if (colors.texture != nullptr) report_.textured += part.surfels.size();
    report_.masked += part.masked;
    report_.widest = std::max(report_.widest, part.widest);
    report_.blended = report_.blended || std::any_of(part.surfels.begin(), part.surfels.end(),
                                                     [](const MeshSurfel& s) { return s.alpha < 255; });
    if (Status status = sink_(part.surfels); !status) return status;
  }
  return {};
}

Status MeshPass::sample(const MaterialWork& work) {
  const Material& material = *work.material;
  std::vector<const Patch*> patches;
  for (const PatchWork& patch : work.patches) patches.push_back(patch.patch);
  const MaterialImages images = images_of(material);
  const std::optional<Texture> joined = join_opacity(images, material, patches);
  const bool missing = material.image && images.color == nullptr;
  MaterialColors colors{material, missing ? material.without_image : material.color, joined ? &*joined : images.color,
                        nullptr};
  std::optional<ChartMap> charts;
  if (colors.texture != nullptr) {
    charts.emplace(patches, colors.texture->size(), material.wrap);
    colors.charts = &*charts;
  }
  std::vector<Task> tasks;
  double waiting = 0;
  for (size_t p = 0; p < work.patches.size(); ++p) {
    const PatchWork& patch = work.patches[p];
    for (size_t t = 0; t < patch.patch->triangles->size(); ++t) {
      const CellTriangle cells = TriangleSampler(colors, edges_, patch, (*patch.patch->triangles)[t], 0).cells();
      const double count = cells.twice_area() / 2;
      const auto rows = static_cast<double>(cells.end_row() - cells.first_row());
      const auto step = static_cast<int64_t>(std::max(1.0, std::ceil(rows * kTask / std::max(count, kTask))));
      for (int64_t row = cells.first_row(); row < cells.end_row(); row += step) {
        tasks.push_back({&patch, p, t, row, std::min(row + step, cells.end_row())});
        waiting += count * static_cast<double>(step) / rows + 1;
        if (waiting < kBatch) continue;
        waiting = 0;
        if (Status status = flush(colors, tasks); !status) return status;
      }
    }
  }
  return flush(colors, tasks);
}

Result<MeshReport> MeshPass::run() {
  report_.triangles = mesh_.triangles();
  report_.notes = mesh_.notes;
  if (Status status = find_work(); !status) return fail(status);
  for (const auto& [image, why] : missing_)
    report_.notes.push_back(why.message + "; its material's colour takes its place");
  plan_work();
  limit_surfels();
  bool culled = true;
  for (const MaterialWork& work : work_) {
    culled = culled && work.material->culled;
    if (Status status = sample(work); !status) return fail(status);
  }
  report_.two_sided = !culled && !edges_.closed();
  return std::move(report_);
}

}  // namespace

Result<MeshReport> sample_mesh(const Mesh& mesh, const SampleOptions& options, const scan::DecodingLimit& limit,
                               const TexelSink& sink) {
  return MeshPass(mesh, options, limit, sink).run();
}

}  // namespace surfcast::mesh
