#include "lab/model_depth.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "kinds/opaque_disc.h"
#include "lab/paint_rows.h"
#include "surfel/drawn_radius.h"

namespace surfcast::lab {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void append(const model::DecodedBlock& block, DrawnSurfels& surfels) {
  const float widest = surfel::largest_drawn_radius(block.radii, block.scatter);
  for (size_t i = 0; i < block.size(); ++i) {
    const bool scatter = block.is_scatter(i);
    surfels.positions.push_back(block.position(i));
    surfels.normals.emplace_back(block.normals[i]);
    surfels.radii.push_back(scatter ? block.radii[i] : std::min(block.radii[i], widest));
    surfels.scatter.push_back(scatter ? 1 : 0);
  }
}

/// The surfels that a camera may see, in its frame.
struct Projected {
  std::vector<glm::dvec3> centres;
  std::vector<glm::dvec3> normals;
  std::vector<double> radii;
  std::vector<PixelBox> boxes;
};

Projected project(const DrawnSurfels& surfels, const geometry::CameraFrame& frame) {
  Projected projected;
  for (size_t i = 0; i < surfels.positions.size(); ++i) {
    const glm::dvec3 centre = frame.to_camera(surfels.positions[i]);
    const PixelBox box = pixels_within(frame, centre, kLargestExtent * surfels.radii[i], kPrefilterReach);
    if (box.empty()) continue;
    const bool scatter = !surfels.scatter.empty() && surfels.scatter[i] != 0;
    const glm::dvec3 normal = scatter ? kinds::facing_eye(centre) : frame.rotate(surfels.normals[i]);
    if (surfels.oriented && !scatter && glm::dot(normal, centre) >= 0) continue;
    projected.centres.push_back(centre);
    projected.normals.push_back(normal);
    projected.radii.push_back(surfels.radii[i]);
    projected.boxes.push_back(box);
  }
  return projected;
}

}  // namespace

Result<DrawnSurfels> drawn_surfels(const model::ModelFile& model) {
  DrawnSurfels surfels;
  surfels.oriented = model.info().oriented;
  for (uint32_t block = 0; block < model.blocks().size(); ++block) {
    if (model.tree().children(block).count > 0) continue;
    const Result<model::DecodedBlock> decoded = model.decode(block, model::WantedScalars::kNone);
    if (!decoded) return fail(decoded);
    if (decoded->size() > 0) append(*decoded, surfels);
  }
  return surfels;
}

DepthPicture model_depths(const DrawnSurfels& surfels, const geometry::CameraFrame& frame) {
  const Projected projected = project(surfels, frame);
  DepthPicture picture(frame.width, frame.height);
  const auto hit = [&](size_t i, int x, int y) {
    const glm::dvec3 ray = frame.ray({x + 0.5, y + 0.5});
    return kinds::hit_disc(projected.centres[i], projected.normals[i], projected.radii[i], ray, frame.eta);
  };
  std::vector<double> occluders(picture.depths.size(), kInfinity);
  for_each_pixel(projected.boxes, frame.height, [&](size_t i, int x, int y) {
    double& occluder = occluders[picture.index(x, y)];
    if (const auto disc = hit(i, x, y)) occluder = std::min(occluder, disc->occluder);
  });
  std::vector<double> forms(picture.depths.size(), kInfinity);
  for_each_pixel(projected.boxes, frame.height, [&](size_t i, int x, int y) {
    const size_t pixel = picture.index(x, y);
    const auto disc = hit(i, x, y);
    if (!disc || disc->depth > occluders[pixel] || disc->form >= forms[pixel]) return;
    forms[pixel] = disc->form;
    picture.depths[pixel] = static_cast<float>(disc->surface);
  });
  return picture;
}

}  // namespace surfcast::lab
