#include "service/pick_service.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <utility>

#include "model/fit_model.h"
#include "service/picture_channels.h"

namespace surfcast::service {
namespace {

geometry::Camera camera_of(const model::ModelFile& model, const picture::PictureRequest& request, bool up_from_model) {
  if (!request.camera) return model::fit_model(model, static_cast<double>(request.width) / request.height);
  geometry::Camera camera = *request.camera;
  if (up_from_model) camera.view_up = model.info().up();
  return camera;
}

/// The query of a picture, for all its pixels.
Result<kinds::PickQuery> query_of(const model::ModelFile& model, const picture::PictureRequest& request,
                                  bool up_from_model) {
  const Result<geometry::CameraFrame> frame =
      geometry::make_camera_frame(camera_of(model, request, up_from_model), request.width, request.height);
  if (!frame) return fail(frame.error());
  return kinds::PickQuery{*frame, glm::dvec2(0), request.clip, request.hidden_classes};
}

/// Returns exceptions (out of memory) as errors, so one job cannot terminate the server.
template <typename Function>
auto guarded(Function function) -> decltype(function()) {
  try {
    return function();
  } catch (const std::exception& error) {
    return fail(ErrorKind::kInternal, std::string("unexpected: ") + error.what());
  }
}

}  // namespace

PickService::PickService(const ModelSource& models, const PickLimits& limits)
    : models_(models),
      most_waiting_(limits.waiting),
      most_points_(limits.profile_points),
      blocks_(limits.block_bytes),
      searched_blocks_(limits.block_bytes),
      pool_(limits.threads),
      searches_(1) {}

PickService::~PickService() {
  stopping_ = true;
}

void PickService::pick(PickJob job, Done done) {
  if (++waiting_ > most_waiting_) {
    --waiting_;
    return done(fail(ErrorKind::kUnavailable, "the server is busy: too many picks wait"));
  }
  pool_.post([this, job = std::move(job), done = std::move(done)] {
    Result<std::optional<kinds::PickedSurfel>> picked = run(job);
    --waiting_;
    done(std::move(picked));
  });
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
    return pick::pick_surfel(**model, *query, blocks_, stopping_);
  });
}

void PickService::find_surface(SurfaceJob job, std::shared_ptr<const std::atomic<bool>> cancelled, SurfaceDone done) {
  searches_.post([this, job = std::move(job), cancelled = std::move(cancelled), done = std::move(done)] {
    done(guarded([&] { return search(job, *cancelled); }));
  });
}

Result<std::vector<pick::FrontPixel>> PickService::search(const SurfaceJob& job, const std::atomic<bool>& cancelled) {
  const Result<std::shared_ptr<const model::ModelFile>> model = models_.open(job.model);
  if (!model) return fail(model.error());
  if (Status status = check_channels(job.channels, (*model)->info()); !status) return fail(std::move(status.error()));
  const Result<kinds::PickQuery> query = query_of(**model, job.request, job.up_from_model);
  if (!query) return fail(query.error());
  return pick::find_front_surface(**model, *query, searched_blocks_, cancelled);
}

void PickService::profile(ProfileJob job, ProfileDone done) {
  if (++profiles_waiting_ > most_waiting_) {
    --profiles_waiting_;
    return done(fail(ErrorKind::kUnavailable, "the server is busy: too many profiles wait"));
  }
  searches_.post([this, job = std::move(job), done = std::move(done)] {
    Result<ProfileResult> result = guarded([&] { return find_profile(job); });
    --profiles_waiting_;
    done(std::move(result));
  });
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
