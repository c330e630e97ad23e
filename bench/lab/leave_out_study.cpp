#include "lab/leave_out_study.h"

#include <algorithm>
#include <glm/common.hpp>

#include "bench_support.h"
#include "lab/model_depth.h"
#include "lab/nearest_points.h"
#include "lab/witness.h"

namespace surfcast::lab {
namespace {

constexpr int kWidth = 640;         // pixels
constexpr int kHeight = 480;        // pixels
constexpr double kNearSpacing = 2;  // pixels

/// The points of a scan, and what is known of each.
struct Judged {
  const LabPoints& points;
  std::vector<bool> out;
  std::vector<WitnessPoint> witness;
};

Judged prepare(const LabPoints& points) {
  Judged judged{points, {}, make_witness(points.positions)};
  for (const glm::dvec3& p : points.positions) judged.out.push_back(left_out(p));
  return judged;
}

picture::PictureRequest request_of(const geometry::Camera& camera) {
  picture::PictureRequest request;
  request.camera = camera;
  request.width = kWidth;
  request.height = kHeight;
  request.shading = picture::Shading::kUnlit;
  return request;
}

/// Models of scans with stored normals have back faces, which are not drawn.
bool faces_away(const Judged& judged, size_t i, bool oriented, const glm::dvec3& eye) {
  if (!oriented || judged.points.normals.empty()) return false;
  return glm::dot(glm::dvec3(judged.points.normals[i]), judged.points.positions[i] - eye) >= 0;
}

/// Everything that one camera sees.
struct View {
  geometry::CameraFrame frame;
  DepthPicture witness;
  DepthPicture model;
  std::vector<SrgbPicture> images;
};

void look_for(const Judged& judged, size_t i, const View& view, CameraResult& result) {
  const glm::dvec3 o = view.frame.to_camera(judged.points.positions[i]);
  if (o.z <= 0) return;
  const glm::dvec2 pixel = view.frame.project(o);
  const double tolerance = depth_tolerance(judged.witness[i].spacing, o.z, view.frame.eta);
  const std::optional<Verdict> open = judge(view.witness, pixel, o.z, tolerance);
  if (!open || *open == Verdict::kHidden) return;
  const Verdict verdict = *judge(view.model, pixel, o.z, tolerance);
  result.counts.count(verdict, judged.witness[i].surface);
  if (verdict != Verdict::kSeen) return;
  const bool near = judged.witness[i].spacing * view.frame.eta / o.z >= kNearSpacing;
  const size_t at = view.model.index(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
  for (size_t k = 0; k < result.colors.size(); ++k) {
    const glm::u8vec3 shown = view.images[k].pixels[at];
    result.colors[k].all.add(shown, judged.points.colors[i]);
    if (near) result.colors[k].near.add(shown, judged.points.colors[i]);
  }
}

CameraResult look(const Judged& judged, const NamedCamera& camera, const DrawnSurfels& surfels,
                  const DrawPictures& draw) {
  const geometry::CameraFrame frame = bench::value_or_exit(geometry::make_camera_frame(camera.camera, kWidth, kHeight));
  View view{frame, witness_depths(judged.points.positions, judged.witness, frame), model_depths(surfels, frame), {}};
  CameraResult result{camera, {}, {}};
  if (!judged.points.colors.empty()) {
    view.images = draw(camera, request_of(camera.camera));
    result.colors.resize(view.images.size());
  }
  for (size_t i = 0; i < judged.points.size(); ++i) {
    if (judged.out[i] && !faces_away(judged, i, surfels.oriented, frame.eye)) look_for(judged, i, view, result);
  }
  return result;
}

/// The largest of the drawn radii over the spacing of the surfaces around: the median over the surface points nearest
/// to it, of every eighth one. 0 if the witness finds no surface.
double largest_radius(const Judged& judged, const DrawnSurfels& surfels) {
  std::vector<glm::dvec3> surface;
  std::vector<double> spacings;
  size_t met = 0;
  for (size_t i = 0; i < judged.points.size(); ++i) {
    if (!judged.witness[i].surface || met++ % 8 != 0) continue;
    surface.push_back(judged.points.positions[i]);
    spacings.push_back(judged.witness[i].spacing);
  }
  const NearestPoints nearest = nearest_points(surface, surfels.positions, 8);
  double largest = 0;
  for (size_t i = 0; i < surfels.positions.size() && nearest.degree > 0; ++i) {
    std::vector<double> around;
    for (const uint32_t j : nearest.of(i)) around.push_back(spacings[j]);
    std::ranges::sort(around);
    largest = std::max(largest, surfels.radii[i] / around[around.size() / 2]);
  }
  return largest;
}

}  // namespace

LeaveOutCounts LeaveOutResult::total() const {
  LeaveOutCounts sum;
  for (const CameraResult& camera : cameras) sum.add(camera.counts);
  return sum;
}

std::vector<KernelColors> LeaveOutResult::colors() const {
  std::vector<KernelColors> sums;
  for (const CameraResult& camera : cameras) {
    sums.resize(std::max(sums.size(), camera.colors.size()));
    for (size_t k = 0; k < camera.colors.size(); ++k) {
      sums[k].all.add(camera.colors[k].all);
      sums[k].near.add(camera.colors[k].near);
    }
  }
  return sums;
}

LeaveOutResult study_points(const std::string& name, const LabPoints& points, Place place, const MakeModel& make_model,
                            const DrawPictures& draw) {
  const Judged judged = prepare(points);
  std::vector<double> spacings;
  for (const WitnessPoint& w : judged.witness) spacings.push_back(w.spacing);
  std::vector<bool> keep = judged.out;
  keep.flip();
  const std::shared_ptr<const model::ModelFile> model = make_model(kept_points(points, keep));
  const DrawnSurfels surfels = bench::value_or_exit(drawn_surfels(*model));
  LeaveOutResult result{name,
                        points.size(),
                        static_cast<uint64_t>(std::ranges::count(judged.out, true)),
                        largest_radius(judged, surfels),
                        {}};
  for (const NamedCamera& camera : leave_out_cameras(points.positions, spacings, place, points.z_up)) {
    result.cameras.push_back(look(judged, camera, surfels, draw));
  }
  return result;
}

}  // namespace surfcast::lab
