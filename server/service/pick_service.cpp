#include "service/pick_service.h"

#include <exception>
#include <memory>
#include <utility>

#include "model/fit_model.h"

namespace surfcast::service {
namespace {

geometry::Camera camera_of(const model::ModelFile& model, const PickJob& job) {
  if (!job.request.camera) return model::fit_model(model, static_cast<double>(job.request.width) / job.request.height);
  geometry::Camera camera = *job.request.camera;
  if (job.up_from_model) camera.view_up = model.info().z_up ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  return camera;
}

}  // namespace

PickService::PickService(const ModelSource& models, const PickLimits& limits)
    : models_(models), most_waiting_(limits.waiting), blocks_(limits.block_bytes), pool_(limits.threads) {}

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

/// Returns exceptions (out of memory) as errors, so one pick cannot terminate the server.
Result<std::optional<kinds::PickedSurfel>> PickService::run(const PickJob& job) {
  try {
    const picture::PictureRequest& request = job.request;
    if (job.x < 0 || job.y < 0 || job.x >= request.width || job.y >= request.height) {
      return fail(ErrorKind::kInvalidInput, "pixel: outside the picture");
    }
    const Result<std::shared_ptr<const model::ModelFile>> model = models_.open(job.model);
    if (!model) return fail(model.error());
    const Result<geometry::CameraFrame> frame =
        geometry::make_camera_frame(camera_of(**model, job), request.width, request.height);
    if (!frame) return fail(frame.error());
    return pick::pick_surfel(**model, {*frame, {job.x + 0.5, job.y + 0.5}, request.clip, request.hidden_classes},
                             blocks_, stopping_);
  } catch (const std::exception& error) {
    return fail(ErrorKind::kInternal, std::string("unexpected: ") + error.what());
  }
}

}  // namespace surfcast::service
