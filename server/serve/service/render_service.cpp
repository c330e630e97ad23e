#include "service/render_service.h"

#include <algorithm>
#include <utility>

#include "base/contract.h"
#include "service/guarded.h"
#include "service/render_service_state.h"
#include "service/renderer_choice.h"

namespace surfcast::service {
namespace {

/// The highest byte of a job's number says whose it is: that of a renderer, or one more than the last of remote models.
constexpr int kOwnerShift = 56;
constexpr size_t kMaxRenderers = 128;
/// Of how many views the renderer is remembered.
constexpr size_t kViews = 4096;

JobId first_job_of(size_t owner) {
  return JobId{owner} << kOwnerShift;
}

/// What may be known of a list.
ModelList list_of(const access::Rights& rights, ModelList all) {
  const auto hidden = [&](const std::string& name) { return !rights.authorize(name).allowed_alone(); };
  std::erase_if(all.names, hidden);
  std::erase_if(all.scans, [&](const ScanStatus& scan) { return hidden(scan.model); });
  return all;
}

}  // namespace

RenderService::RenderService(std::vector<std::unique_ptr<State>> local, std::unique_ptr<State> remote)
    : local_(std::move(local)), remote_(std::move(remote)), views_(kViews) {}

/// Whose queries about a model are.
RenderService::State& RenderService::state_of(const std::string& model) const {
  return remote_ && local_.front()->models.remote(model) ? *remote_ : *local_.front();
}

RenderService::State& RenderService::state_of(JobId job) const {
  const auto owner = static_cast<size_t>(job >> kOwnerShift);
  return remote_ && owner >= local_.size() ? *remote_ : *local_.at(owner);
}

/// Who draws a picture. One that may make another one obsolete is drawn where that is.
RenderService::State& RenderService::drawer_of(const PictureJob& job) {
  const std::string model = job.model.served_name();
  if (State& state = state_of(model); local_.size() == 1 || &state == remote_.get()) return state;
  if (State& state = state_of(job.supersedes); job.supersedes != kNoJob && state.has(job.supersedes)) return state;
  const RendererChoice choice = rank_renderers(model, local_.size());
  const size_t first = local_[choice.first]->queued();
  const size_t second = local_[choice.second]->queued();
  if (job.request.viewer == 0) return *local_[choose_renderer(choice, first, second, std::nullopt)];
  const std::lock_guard lock(views_mutex_);
  const std::shared_ptr<const size_t> former = views_.find(job.request.viewer);
  const size_t chosen = choose_renderer(choice, first, second, former ? std::optional(*former) : std::nullopt);
  views_.erase_range(job.request.viewer, job.request.viewer + 1);
  views_.put(job.request.viewer, std::make_shared<const size_t>(chosen), 1);
  return *local_[chosen];
}

std::vector<RenderService::State*> RenderService::all() const {
  std::vector<State*> states;
  for (const auto& state : local_) states.push_back(state.get());
  if (remote_) states.push_back(remote_.get());
  return states;
}

Result<std::unique_ptr<RenderService>> RenderService::start(
    const ModelSource& models, FrameRendererFactory make_renderer, const ServiceLimits& limits,
    std::shared_ptr<ModelQueries> queries, std::optional<Drawers> remote, std::vector<FrameRendererFactory> more) {
  SURFCAST_EXPECTS(more.size() < kMaxRenderers);
  std::vector<std::unique_ptr<State>> local;
  for (size_t i = 0; i <= more.size(); ++i) local.push_back(std::make_unique<State>(models, limits, first_job_of(i)));
  auto far = remote ? std::make_unique<State>(models, limits, first_job_of(local.size())) : nullptr;
  // Stops what has been started if the rest does not start.
  std::unique_ptr<RenderService> service(new RenderService(std::move(local), std::move(far)));
  const std::vector<State*> states = service->all();
  const auto memory = std::make_shared<PictureMemory>(State::picture_memory_limit(limits), [states] {
    for (State* const state : states) state->look_again();
  });
  for (State* const state : states) state->memory = memory;
  const auto picks = std::make_shared<PickService>(models, limits.picks, std::move(queries));
  more.insert(more.begin(), std::move(make_renderer));
  for (size_t i = 0; i < more.size(); ++i) {
    if (Status status = service->local_[i]->start_threads(std::move(more[i]), picks); !status) {
      return fail(status);
    }
  }
  if (!remote) return service;
  auto far_picks = std::make_shared<PickService>(models, limits.picks, std::move(remote->queries));
  if (Status status = service->remote_->start_threads(std::move(remote->make_renderer), std::move(far_picks));
      !status) {
    return fail(status);
  }
  return service;
}

/// What is about all renderers ends with the first one.
RenderService::~RenderService() {
  const std::vector<State*> states = all();
  std::for_each(states.rbegin(), states.rend(), [](State* state) { state->stop(); });
}

JobId RenderService::draw(const Client& client, PictureJob job, PictureDone done) {
  State& state = drawer_of(job);
  return state.add(client, std::move(job), std::move(done));
}

bool RenderService::cancel(JobId id) {
  return state_of(id).cancel(id);
}

JobId RenderService::encode(std::shared_ptr<const picture::Frame> frame, PictureJob picture, PictureDone done,
                            const Client& client) {
  SURFCAST_EXPECTS(frame->image.format == picture::pixel_format_of(picture.format));
  State& state = state_of(picture.model.served_name());
  const auto job = std::make_shared<RenderJob>(client, std::move(picture), std::move(done));
  job->picture.priority = Priority::kStill;
  job->small = is_small(job->picture);
  job->memory = state.memory->take(client.id, memory_of(job->picture));
  {
    const std::lock_guard lock(state.mutex);
    job->id = ++state.last_id;
    state.jobs.emplace(job->id, job);
    ++(job->small ? state.small_in_encoding : state.in_encoding[static_cast<size_t>(Priority::kStill)]);
  }
  state.pool->post(
      [&state, job, frame = std::move(frame)]() mutable { state.encode_one(job, SharedFrame(std::move(frame))); },
      client.id, job->small ? TaskSize::kSmall : TaskSize::kLarge);
  return job->id;
}

bool RenderService::replace(JobId id, PictureJob picture) {
  State& state = state_of(id);
  if (!state.check(picture)) return false;
  const std::lock_guard lock(state.mutex);
  if (!state.queue.contains(id)) return false;
  SURFCAST_EXPECTS(state.jobs.at(id)->picture.priority == picture.priority);
  state.jobs.at(id)->picture = std::move(picture);
  return true;
}

void RenderService::models_changed() {
  for (State* const state : all()) state->models_changed();
}

uint64_t RenderService::edition(const access::AuthorizedModel& model) const {
  return local_.front()->models.edition(model.served_name());
}

void RenderService::list_models(access::Rights rights, ListDone done, ClientId client) {
  const auto list = [state = local_.front().get(), rights = std::move(rights)]() -> Result<ModelList> {
    return list_of(rights, {state->models.names(), state->models.scans()});
  };
  local_.front()->lookups->post([list, done = std::move(done)] { done(guarded(list).value_or(ModelList())); }, client);
}

void RenderService::describe_model(const access::AuthorizedModel& model, DescriptionDone done, ClientId client) {
  const std::string name = model.served_name();
  State& state = state_of(name);
  state.when_available(name, [state = &state, name, done = std::move(done), client](const Status& there) {
    if (!there) return done(fail(there));
    state->lookups->post([state, name, done] { deliver(done, guarded([&] { return state->models.describe(name); })); },
                         client);
  });
}

void RenderService::pick(PickJob job, PickService::Done done, ClientId client) {
  const std::string model = job.model.served_name();
  State& state = state_of(model);
  const auto run = [state = &state, job = std::move(job), done = std::move(done), client](const Status& there) {
    if (!there) return done(fail(there));
    state->picks->pick(job, done, client);
  };
  state.when_available(model, run);
}

void RenderService::profile(ProfileJob job, PickService::ProfileDone done, ClientId client) {
  const std::string model = job.model.served_name();
  State& state = state_of(model);
  const auto run = [state = &state, job = std::move(job), done = std::move(done), client](const Status& there) {
    if (!there) return done(fail(there));
    state->picks->profile(job, done, client);
  };
  state.when_available(model, run);
}

void RenderService::points(PointsJob job, std::shared_ptr<const std::atomic<bool>> cancelled,
                           PickService::PointsDone done, ClientId client) {
  const std::string model = job.model.served_name();
  State& state = state_of(model);
  const auto run = [state = &state, job = std::move(job), cancelled = std::move(cancelled), done = std::move(done),
                    client](const Status& there) {
    if (!there) return done(fail(there));
    state->picks->points(job, cancelled, done, client);
  };
  state.when_available(model, run);
}

void RenderService::next_piece(std::shared_ptr<PointStream> stream, PickService::PieceDone done, ClientId client) {
  PickService* const service = stream->service();
  SURFCAST_EXPECTS(service != nullptr);
  service->next_piece(std::move(stream), std::move(done), client);
}

std::vector<picture::DeviceInfo> RenderService::devices() const {
  std::vector<picture::DeviceInfo> devices;
  for (const auto& state : local_) devices.push_back(state->device);
  return devices;
}

picture::MemoryBudgets RenderService::memory() const {
  picture::MemoryBudgets all;
  for (const auto& state : local_) {
    all.gpu += state->device.memory.gpu;
    all.host += state->device.memory.host;
  }
  return all;
}

size_t RenderService::picture_memory() const {
  return local_.front()->memory->held();
}

size_t RenderService::queued() const {
  size_t queued = 0;
  for (const State* const state : all()) queued += state->queued();
  return queued;
}

}  // namespace surfcast::service
