#include "service/pick_service.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "model/fit_model.h"
#include "render/display_options.h"
#include "service/glyph_sights.h"
#include "service/guarded.h"
#include "service/picture_channels.h"
#include "service/volume_sights.h"

namespace surfcast::service {
namespace {

geometry::Camera camera_of(const model::ModelFile& model, const picture::PictureRequest& request, bool up_from_model) {
  if (!request.camera) return model::fit_model(model, static_cast<double>(request.width) / request.height);
  geometry::Camera camera = *request.camera;
  if (up_from_model) camera.view_up = model.info().up();
  return camera;
}

/// How surfels are seen through. As in the picture, but for X-rays of surfaces, whose opacities depend on the angle.
void set_transparency(const model::ModelFile& model, const picture::PictureRequest& request, kinds::PickQuery& query) {
  const render::SeenThrough through = render::seen_through(model.info(), request);
  query.transparent = through.any;
  query.by_file = through.by_file;
  if (through.ghosts) query.ghost = request.ghost;
  if (!through.by_class) return;
  query.class_opacities.assign(256, 1);
  for (const picture::ClassOpacity& of : request.class_opacities) query.class_opacities[of.code] = of.opacity;
}

/// The query of a picture, for all its pixels.
Result<kinds::PickQuery> query_of(const model::ModelFile& model, const picture::PictureRequest& request,
                                  bool up_from_model) {
  const Result<geometry::CameraFrame> frame =
      geometry::make_camera_frame(camera_of(model, request, up_from_model), request.width, request.height);
  if (!frame) return fail(frame.error());
  kinds::PickQuery query{*frame, glm::dvec2(0), request.clip, request.hidden_classes};
  query.opacity = request.opacity;
  set_transparency(model, request, query);
  if (!model.volumes().empty()) {
    query.volumes = std::make_shared<const std::vector<kinds::VolumeSight>>(volume_sights(model, request));
  }
  if (!model.ellipsoid_sources().empty()) {
    GlyphSights sights = glyph_sights(model, request);
    query.glyphs = std::make_shared<const std::vector<kinds::GlyphSight>>(std::move(sights.sights));
    query.reach = sights.reach;
  }
  return query;
}

}  // namespace

PickService::PickService(const ModelSource& models, const PickLimits& limits)
    : models_(models),
      most_waiting_(limits.waiting),
      most_points_(limits.profile_points),
      most_blocks_(limits.blocks),
      blocks_(limits.block_bytes),
      searched_blocks_(limits.block_bytes),
      pool_(limits.threads, 0, limits.waiting),
      searches_(1) {}

PickService::~PickService() {
  stopping_ = true;
}

void PickService::pick(PickJob job, const Done& done, ClientId client) {
  const bool room = ++waiting_ <= most_waiting_;
  const auto task = [this, job = std::move(job), done] {
    Result<std::optional<kinds::PickedSurfel>> picked = run(job);
    --waiting_;
    deliver(done, std::move(picked));
  };
  if (room && pool_.post(task, client)) return;
  --waiting_;
  done(fail(ErrorKind::kUnavailable, "the server is busy: too many picks wait"));
}

Result<std::optional<kinds::PickedSurfel>> PickService::run(const PickJob& job) {
  return guarded([&]() -> Result<std::optional<kinds::PickedSurfel>> {
    const picture::PictureRequest& request = job.request;
    if (job.x < 0 || job.y < 0 || job.x >= request.width || job.y >= request.height) {
      return fail(ErrorKind::kInvalidInput, "pixel: outside the picture");
    }
    const Result<std::shared_ptr<const model::ModelFile>> model = models_.open(job.model);
    if (!model) return fail(model.error());
    Result<kinds::PickQuery> query = query_of(**model, request, job.up_from_model);
    if (!query) return fail(query.error());
    query->pixel = {job.x + 0.5, job.y + 0.5};
    return pick::pick_surfel(**model, *query, blocks_, stopping_, most_blocks_);
  });
}

void PickService::find_surface(SurfaceJob job, std::shared_ptr<const std::atomic<bool>> cancelled, SurfaceDone done,
                               ClientId client) {
  const auto task = [this, job = std::move(job), cancelled = std::move(cancelled), done = std::move(done)] {
    deliver(done, guarded([&] { return search(job, *cancelled); }));
  };
  searches_.post(task, client);
}

Result<std::vector<pick::FrontPixel>> PickService::search(const SurfaceJob& job, const std::atomic<bool>& cancelled) {
  const Result<std::shared_ptr<const model::ModelFile>> model = models_.open(job.model);
  if (!model) return fail(model.error());
  if (Status status = check_channels(job.channels, (*model)->info()); !status) return fail(std::move(status.error()));
  const Result<kinds::PickQuery> query = query_of(**model, job.request, job.up_from_model);
  if (!query) return fail(query.error());
  return pick::find_front_surface(**model, *query, searched_blocks_, cancelled);
}

void PickService::profile(ProfileJob job, ProfileDone done, ClientId client) {
  if (++profiles_waiting_ > most_waiting_) {
    --profiles_waiting_;
    return done(fail(ErrorKind::kUnavailable, "the server is busy: too many profiles wait"));
  }
  const auto task = [this, job = std::move(job), done = std::move(done)] {
    Result<ProfileResult> result = guarded([&] { return find_profile(job); });
    --profiles_waiting_;
    deliver(done, std::move(result));
  };
  searches_.post(task, client);
}

Result<ProfileResult> PickService::find_profile(const ProfileJob& job) const {
  const Result<std::shared_ptr<const model::ModelFile>> model = models_.open(job.model);
  if (!model) return fail(model.error());
  pick::BandQuery query = job.query;
  query.most = query.most == 0 ? most_points_ : std::min(query.most, most_points_);
  Result<pick::Band> band = pick::find_band(**model, query, stopping_);
  if (!band) return fail(band.error());
  const model::ModelInfo& info = (*model)->info();
  return ProfileResult{std::move(*band), info.z_up, info.color_bits, info.scalar_names};
}

}  // namespace surfcast::service
