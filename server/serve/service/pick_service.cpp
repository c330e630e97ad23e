#include "service/pick_service.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "service/guarded.h"
#include "service/local_queries.h"
#include "service/picture_channels.h"

namespace surfcast::service {
namespace {

using ModelPointer = ModelQueries::ModelPointer;

/// Works on a model. One that was replaced in its store meanwhile is opened anew, once.
template <typename Work>
auto on_model(const ModelSource& models, const std::string& name, const Work& work) {
  const auto once = [&]() -> decltype(work(std::declval<const ModelPointer&>())) {
    const Result<ModelPointer> model = models.open(name);
    if (!model) return fail(model);
    return work(*model);
  };
  auto result = once();
  if (result || result.error().kind != ErrorKind::kReplaced) return result;
  return once();
}

/// Empty of a plain model, and if the process that picked states what there is not.
std::string member_name(const model::ModelFile& model, const kinds::PickedSurfel& picked) {
  const bool known = picked.member && *picked.member < model.members().size();
  return known ? model.members()[*picked.member].name : std::string();
}

}  // namespace

PickService::PickService(const ModelSource& models, const PickLimits& limits, std::shared_ptr<ModelQueries> queries)
    : models_(models),
      queries_(queries ? std::move(queries) : local_queries(limits.block_bytes)),
      most_waiting_(limits.waiting),
      most_points_(limits.profile_points),
      most_blocks_(limits.blocks),
      most_region_points_(limits.region_points),
      region_bytes_(limits.region_bytes),
      regions_(limits.regions),
      pool_(limits.threads, 0, limits.waiting),
      searches_(1) {}

PickService::~PickService() {
  stopping_ = true;
}

void PickService::pick(PickJob job, const Done& done, ClientId client) {
  const bool room = ++waiting_ <= most_waiting_;
  const auto task = [this, job = std::move(job), done] {
    Result<std::optional<PickedPoint>> picked = run(job);
    --waiting_;
    deliver(done, std::move(picked));
  };
  if (room && pool_.post(task, client)) return;
  --waiting_;
  done(fail(ErrorKind::kUnavailable, "the server is busy: too many picks wait"));
}

Result<std::optional<PickedPoint>> PickService::run(const PickJob& job) {
  return guarded([&]() -> Result<std::optional<PickedPoint>> {
    const picture::PictureRequest& request = job.request;
    if (job.x < 0 || job.y < 0 || job.x >= request.width || job.y >= request.height) {
      return fail(ErrorKind::kInvalidInput, "pixel: outside the picture");
    }
    return on_model(
        models_, job.model.served_name(), [&](const ModelPointer& model) -> Result<std::optional<PickedPoint>> {
          const PixelQuery query{{request, job.up_from_model}, job.x, job.y, most_blocks_};
          auto picked = queries_->pick(model, query, stopping_);
          if (!picked) return fail(picked);
          if (!*picked) return std::nullopt;
          const std::optional<glm::dvec3> source_position = source_positions_.find(*model, (*picked)->position);
          std::string member = member_name(*model, **picked);
          return PickedPoint{std::move(**picked), source_position, std::move(member)};
        });
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
  return on_model(models_, job.model.served_name(),
                  [&](const ModelPointer& model) -> Result<std::vector<pick::FrontPixel>> {
                    if (Status status = check_channels(job.channels, model->info()); !status) return fail(status);
                    return queries_->front_surface(model, {job.request, job.up_from_model}, cancelled);
                  });
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

void PickService::points(PointsJob job, std::shared_ptr<const std::atomic<bool>> cancelled, PointsDone done,
                         ClientId client) {
  std::shared_ptr<const void> place = regions_.take(client);
  if (!place) {
    return done(fail(ErrorKind::kUnavailable, "the server is busy: the points of too many regions are on their way"));
  }
  const auto task = [this, job = std::move(job), cancelled = std::move(cancelled), place = std::move(place),
                     done = std::move(done), client] {
    const auto stream = guarded([&] { return open_stream(job, cancelled, place); });
    if (!stream) return deliver(done, stream);
    count(*stream, done, client);
  };
  searches_.post(task, client);
}

Result<std::shared_ptr<PointStream>> PickService::open_stream(PointsJob job,
                                                              std::shared_ptr<const std::atomic<bool>> cancelled,
                                                              std::shared_ptr<const void> place) {
  const Result<ModelPointer> model = models_.open(job.model.served_name());
  if (!model) return fail(model);
  PointsQuery& query = job.query;
  query.model = job.model.name();
  query.most = query.most == 0 ? most_region_points_ : std::min(query.most, most_region_points_);
  Result<std::unique_ptr<PointStream>> stream = queries_->points(*model, query, std::move(cancelled));
  if (!stream) return fail(stream);
  (*stream)->keep(std::move(place));
  (*stream)->set_service(*this);
  return std::shared_ptr<PointStream>(std::move(*stream));
}

/// A turn of counting, and then the next one.
void PickService::count(const std::shared_ptr<PointStream>& stream, const PointsDone& done, ClientId client) {
  if (stopping_) return deliver(done, Result<std::shared_ptr<PointStream>>(fail(ErrorKind::kCancelled, "cancelled")));
  const Result<bool> whole = guarded([&] { return stream->count(); });
  if (!whole) return deliver(done, Result<std::shared_ptr<PointStream>>(fail(whole)));
  if (*whole) return deliver(done, Result<std::shared_ptr<PointStream>>(stream));
  searches_.post([this, stream, done, client] { count(stream, done, client); }, client);
}

void PickService::next_piece(std::shared_ptr<PointStream> stream, PieceDone done, ClientId client) {
  const auto task = [this, stream = std::move(stream), done = std::move(done)] {
    deliver(done, guarded([&]() -> Result<PointPiece> {
              if (stopping_) return fail(ErrorKind::kCancelled, "cancelled");
              return stream->next(region_bytes_);
            }));
  };
  searches_.post(task, client);
}

Result<ProfileResult> PickService::find_profile(const ProfileJob& job) const {
  pick::BandQuery query = job.query;
  query.most = query.most == 0 ? most_points_ : std::min(query.most, most_points_);
  return on_model(models_, job.model.served_name(), [&](const ModelPointer& model) -> Result<ProfileResult> {
    Result<pick::Band> band = queries_->band(model, query, stopping_);
    if (!band) return fail(band);
    const model::ModelInfo& info = model->info();
    return ProfileResult{std::move(*band), info.z_up, info.color_bits, info.scalar_names};
  });
}

}  // namespace surfcast::service
