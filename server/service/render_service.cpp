#include "service/render_service.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <future>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "base/contract.h"
#include "base/preemption.h"
#include "base/stopwatch.h"
#include "encode/encode_picture.h"
#include "service/draw_shares.h"
#include "service/picture_channels.h"
#include "service/worker_pool.h"

namespace surfcast::service {
namespace {

tl::unexpected<Error> cancelled_error() {
  return fail(ErrorKind::kCancelled, "the request was cancelled");
}

tl::unexpected<Error> busy_error() {
  return fail(ErrorKind::kUnavailable, "the server is busy: too many pictures wait");
}

/// The number of no job: jobs count from 1.
constexpr JobId kNoJob = 0;

/// Runs a function and returns exceptions (out of memory in a library) as errors, so one job cannot terminate the
/// server.
template <typename Function>
auto guarded(Function function) -> decltype(function()) {
  try {
    return function();
  } catch (const std::exception& error) {
    return fail(ErrorKind::kInternal, std::string("unexpected: ") + error.what());
  }
}

}  // namespace

struct RenderService::State {
  struct Job {
    JobId id = 0;
    SessionId session = 0;
    PictureJob picture;
    PictureDone done;
    std::atomic<bool> cancelled = false;
    std::vector<pick::FrontPixel> front;  ///< for PictureJob::channels
    double search_ms = 0;                 ///< to find it
    Stopwatch since_submission;           ///< to the render thread
    double waited_ms = 0;                 ///< for the render thread
    double draw_ms = 0;
    std::atomic<bool> encoding = false;  ///< encoding has begun
  };
  using JobPointer = std::shared_ptr<Job>;
  /// Gets an error if the model is not there in time.
  using Proceed = std::function<void(const Status& there)>;
  using SharedFrame = std::shared_ptr<const picture::Frame>;

  State(const ModelSource& source, const ServiceLimits& service_limits)
      : models(source), limits(service_limits), queue(service_limits.queued_jobs) {}

  // Render thread.
  void run(const FrameRendererFactory& make_renderer, std::promise<Status> started);
  [[nodiscard]] bool idle_for_a_moment();
  [[nodiscard]] bool has_waiting(Priority priority) const;
  [[nodiscard]] bool may_draw(Priority priority) const;
  [[nodiscard]] std::optional<Priority> next_priority() const;
  JobPointer start(JobId id, std::unique_lock<std::mutex>& lock);
  JobPointer next_job();
  JobPointer next_motion();
  JobPointer next_still_of_others(SessionId session);
  Result<picture::Frame> render_frame(FrameRenderer& renderer, Job& job, const Preemption& preemption);
  void draw_one(FrameRenderer& renderer, const JobPointer& job, const Preemption& preemption);
  void draw_motion(FrameRenderer& renderer, const JobPointer& job, bool others_wait);
  bool draw_waiting_motion(FrameRenderer& renderer);
  void draw_still(FrameRenderer& renderer, const JobPointer& job, bool nested);
  void cancel_superseded(JobId id);

  // Pool.
  static EncodedPicture describe(const Job& job, const picture::Frame& frame);
  static Result<std::vector<std::byte>> encode_file(const Job& job, const picture::Frame& frame);
  static Result<EncodedPicture> encode(Job& job, const Result<SharedFrame>& shared);
  void encode_one(const JobPointer& job, Result<SharedFrame> frame);

  // Any thread.
  [[nodiscard]] Status check(const PictureJob& picture) const;
  JobId add(SessionId session, PictureJob picture, PictureDone done);
  void search(const JobPointer& job);
  void end_search(const JobPointer& job, Result<std::vector<pick::FrontPixel>> front);
  [[nodiscard]] bool enqueue(const Job& job);
  void proceed(const JobPointer& job);
  void end_waiting(const JobPointer& job, const Status& there);
  [[nodiscard]] bool await_model(JobId job, const std::string& model, Proceed proceed);
  [[nodiscard]] bool waits_for_model(const PictureJob& picture) const;
  void when_available(const std::string& model, const Proceed& proceed);
  void models_changed();
  void finish(const JobPointer& job, Result<EncodedPicture> result);
  void stop();

  const ModelSource& models;
  const ServiceLimits limits;
  DrawShares shares;           ///< of the render thread
  picture::DeviceInfo device;  ///< set before start() returns, constant afterwards
  int max_resolution = 0;      ///< likewise

  mutable std::mutex mutex;  ///< guards the following members
  std::condition_variable wake;
  JobQueue queue;
  /// What waits for a model.
  struct Awaiting {
    JobId job = kNoJob;  ///< of a picture
    std::string model;
    Stopwatch since;
    Proceed proceed;
  };
  std::vector<Awaiting> awaiting;
  std::map<JobId, JobPointer> jobs;  ///< outstanding: waiting, being drawn or being encoded
  JobId last_id = 0;
  std::array<size_t, 2> in_encoding{};  ///< pictures being drawn or encoded, by priority
  size_t searching = 0;                 ///< jobs whose front surface is being found
  bool stopping = false;

  // Declared last, so the threads end before the members that they use.
  std::unique_ptr<PickService> picks;
  std::unique_ptr<WorkerPool> pool;
  std::unique_ptr<WorkerPool> motion_pool;  ///< one thread
  std::jthread render_thread;
};

void RenderService::State::run(const FrameRendererFactory& make_renderer, std::promise<Status> started) {
  Result<std::unique_ptr<FrameRenderer>> renderer = guarded([&] { return make_renderer(); });
  if (!renderer) {
    started.set_value(fail(renderer.error()));
    return;
  }
  device = (*renderer)->device();
  max_resolution = (*renderer)->max_resolution();
  started.set_value({});
  bool more_to_warm_up = true;
  for (;;) {
    if (more_to_warm_up && idle_for_a_moment()) {
      more_to_warm_up = guarded([&]() -> Result<bool> { return (*renderer)->warm_up(); }).value_or(false);
      continue;
    }
    const JobPointer job = next_job();
    if (!job) return;
    more_to_warm_up = true;  // there may be another model
    if (job->picture.priority == Priority::kMotion) {
      draw_motion(**renderer, job, has_waiting(Priority::kStill));
    } else {
      draw_still(**renderer, job, /*nested=*/false);
    }
  }
}

/// Waits for a moment. True if no job could be drawn meanwhile.
bool RenderService::State::idle_for_a_moment() {
  constexpr std::chrono::milliseconds kMoment{300};
  std::unique_lock lock(mutex);
  return !wake.wait_for(lock, kMoment, [this] { return stopping || next_priority(); });
}

bool RenderService::State::has_waiting(Priority priority) const {
  const std::lock_guard lock(mutex);
  return queue.has_waiting(priority);
}

/// True if a job of this priority waits and the encoders have room for its picture.
bool RenderService::State::may_draw(Priority priority) const {
  return queue.has_waiting(priority) && in_encoding[static_cast<size_t>(priority)] < limits.frames_in_encoding;
}

std::optional<Priority> RenderService::State::next_priority() const {
  const bool still = may_draw(Priority::kStill);
  if (may_draw(Priority::kMotion) && (shares.motion_first() || !still)) return Priority::kMotion;
  return still ? std::optional(Priority::kStill) : std::nullopt;
}

/// Takes a job that has left the queue. Null if the job has waited too long. It is then refused, because its client has
/// probably given up, and drawing it would delay other jobs past their own timeout.
RenderService::State::JobPointer RenderService::State::start(JobId id, std::unique_lock<std::mutex>& lock) {
  JobPointer job = jobs.at(id);
  job->waited_ms = job->since_submission.milliseconds();
  if (job->waited_ms <= static_cast<double>(limits.queue_timeout.count())) {
    ++in_encoding[static_cast<size_t>(job->picture.priority)];
    return job;
  }
  lock.unlock();
  finish(job, fail(ErrorKind::kUnavailable, "the server is busy: the picture waited too long"));
  lock.lock();
  return nullptr;
}

/// Waits for a job that may be drawn; null if the service stops.
RenderService::State::JobPointer RenderService::State::next_job() {
  std::unique_lock lock(mutex);
  for (;;) {
    wake.wait(lock, [this] { return stopping || next_priority(); });
    if (stopping) return nullptr;
    if (JobPointer job = start(*queue.pop(*next_priority()), lock)) return job;
  }
}

/// The motion job that preempts the current still picture; null if there is none.
RenderService::State::JobPointer RenderService::State::next_motion() {
  std::unique_lock lock(mutex);
  while (!stopping && may_draw(Priority::kMotion) && shares.motion_first()) {
    if (JobPointer job = start(*queue.pop(Priority::kMotion), lock)) return job;
  }
  return nullptr;
}

/// The still job of another session that is drawn in the middle of the current one; null if there is none.
RenderService::State::JobPointer RenderService::State::next_still_of_others(SessionId session) {
  std::unique_lock lock(mutex);
  while (!stopping && may_draw(Priority::kStill)) {
    const std::optional<JobId> id = queue.pop_of_others(Priority::kStill, session);
    if (!id) return nullptr;
    if (JobPointer job = start(*id, lock)) return job;
  }
  return nullptr;
}

Result<picture::Frame> RenderService::State::render_frame(FrameRenderer& renderer, Job& job,
                                                          const Preemption& preemption) {
  picture::PictureRequest request = job.picture.request;
  request.format = picture::pixel_format_of(job.picture.format);
  if (request.camera && job.picture.up_from_model) {
    const Result<ModelDescription> description = models.describe(job.picture.model);
    if (!description) return fail(description.error());
    request.camera->view_up = description->info.z_up ? glm::dvec3{0, 0, 1} : glm::dvec3{0, 1, 0};
  }
  return renderer.draw(job.picture.model, request, preemption);
}

void RenderService::State::draw_motion(FrameRenderer& renderer, const JobPointer& job, bool others_wait) {
  draw_one(renderer, job, job->cancelled);
  shares.drew_motion(job->draw_ms, others_wait);
}

bool RenderService::State::draw_waiting_motion(FrameRenderer& renderer) {
  bool any = false;
  for (; const JobPointer motion = next_motion(); any = true) draw_motion(renderer, motion, /*others_wait=*/true);
  return any;
}

/// Draws a still picture, and motion pictures between its batches. If it takes long, still pictures of other sessions
/// are drawn in its middle, one after another. Between two of them it goes on for a turn, and at least for as long as
/// the one before took: each side has half of the time.
void RenderService::State::draw_still(FrameRenderer& renderer, const JobPointer& job, bool nested) {
  const auto turn_ms = static_cast<double>(limits.still_turn.count());
  double left_of_turn = turn_ms;
  Stopwatch since_others;
  const Preemption preemption(job->cancelled, [&] {
    const double drawn_ms = since_others.milliseconds();
    shares.drew_other(drawn_ms);
    left_of_turn -= drawn_ms;
    bool preempted = draw_waiting_motion(renderer);
    const JobPointer other = !nested && left_of_turn <= 0 ? next_still_of_others(job->session) : nullptr;
    if (other) {
      const Stopwatch watch;
      draw_still(renderer, other, /*nested=*/true);
      left_of_turn = std::max(turn_ms, watch.milliseconds());
      preempted = true;
    }
    since_others = Stopwatch();
    return preempted;
  });
  draw_one(renderer, job, preemption);
  shares.drew_other(since_others.milliseconds());
}

void RenderService::State::draw_one(FrameRenderer& renderer, const JobPointer& job, const Preemption& preemption) {
  const WorkStopwatch watch(preemption);
  Result<picture::Frame> frame = guarded([&] { return render_frame(renderer, *job, preemption); });
  job->draw_ms = watch.milliseconds();
  Result<SharedFrame> shared = SharedFrame();
  if (frame) {
    frame->stats.stages.insert(frame->stats.stages.begin(), picture::StageTime{"queue", job->waited_ms});
    cancel_superseded(job->picture.supersedes);
    shared = std::make_shared<const picture::Frame>(std::move(*frame));
  } else {
    shared = fail(frame.error());
  }
  WorkerPool& encoder = job->picture.priority == Priority::kMotion ? *motion_pool : *pool;
  encoder.post([this, job, shared = std::move(shared)]() mutable { encode_one(job, std::move(shared)); });
}

/// Cancels a picture that a newer one supersedes, if its encoding has not begun.
void RenderService::State::cancel_superseded(JobId id) {
  const std::lock_guard lock(mutex);
  const auto found = jobs.find(id);
  if (found != jobs.end() && !found->second->encoding) found->second->cancelled = true;
}

/// The description of a picture and its cost; without its bytes.
EncodedPicture RenderService::State::describe(const Job& job, const picture::Frame& frame) {
  EncodedPicture picture;
  picture.format = job.picture.format;
  picture.width = frame.image.width;
  picture.height = frame.image.height;
  picture.camera = frame.camera;
  picture.normalization = job.picture.request.normalization;
  picture.spacing = job.picture.request.spacing;
  picture.converged = frame.converged;
  picture.nothing_pending = frame.nothing_pending;
  picture.cut = frame.cut;
  picture.preview = frame.preview;
  picture.waited_ms = job.waited_ms;
  picture.draw_ms = job.draw_ms;
  picture.stats = frame.stats;
  return picture;
}

/// The bytes of a picture's file, with its channels.
Result<std::vector<std::byte>> RenderService::State::encode_file(const Job& job, const picture::Frame& frame) {
  const PictureJob& picture = job.picture;
  if (picture.channels.none()) {
    return surfcast::encode::encode_picture(frame.image, picture.format, picture.quality);
  }
  const picture::Channels channels = make_channels(picture.channels, frame, job.front);
  return surfcast::encode::encode_picture(frame.image, picture.format, picture.quality, &channels);
}

Result<EncodedPicture> RenderService::State::encode(Job& job, const Result<SharedFrame>& shared) {
  if (!shared) return fail(shared.error());
  job.encoding = true;
  if (job.cancelled) return cancelled_error();
  const Stopwatch watch;
  const picture::Frame& frame = **shared;
  EncodedPicture picture = describe(job, frame);
  if (job.picture.keep_frame) picture.frame = *shared;
  if (!frame.image.pixels.empty()) {
    Result<std::vector<std::byte>> bytes = encode_file(job, frame);
    if (!bytes) return fail(bytes.error());
    picture.bytes = std::move(*bytes);
  }
  if (job.cancelled) return cancelled_error();
  picture.encode_ms = watch.milliseconds();
  if (!job.front.empty()) picture.stats.stages.push_back({"surface", job.search_ms});
  picture.stats.stages.push_back({"encode", picture.encode_ms});
  return picture;
}

void RenderService::State::encode_one(const JobPointer& job, Result<SharedFrame> frame) {
  Result<EncodedPicture> result = guarded([&] { return encode(*job, frame); });
  frame = cancelled_error();  // releases the pixels before the render thread may draw more
  {
    const std::lock_guard lock(mutex);
    --in_encoding[static_cast<size_t>(job->picture.priority)];
  }
  wake.notify_one();
  finish(job, std::move(result));
}

Status RenderService::State::check(const PictureJob& picture) const {
  const int width = picture.request.width;
  const int height = picture.request.height;
  const std::string size = std::to_string(width) + "," + std::to_string(height);
  if (width < 1 || height < 1) return fail(ErrorKind::kInvalidInput, "resolution: must be at least 1,1");
  if (const int side = std::min(max_resolution, limits.side); width > side || height > side) {
    return fail(ErrorKind::kLimit, "resolution: " + size + " is beyond " + std::to_string(side) + " pixels a side");
  }
  if (static_cast<size_t>(width) * static_cast<size_t>(height) > limits.pixels) {
    return fail(ErrorKind::kLimit,
                "resolution: " + size + " is more than " + std::to_string(limits.pixels) + " pixels");
  }
  return {};
}

/// Views ask again by themselves.
bool RenderService::State::waits_for_model(const PictureJob& picture) const {
  return picture.request.loading == picture::Loading::kWait && models.awaited(picture.model);
}

/// Puts a job into the queue, or makes room for the search that precedes it. False if there is no room.
bool RenderService::State::enqueue(const Job& job) {
  if (!needs_front_surface(job.picture.channels)) return queue.push(job.session, job.id, job.picture.priority);
  if (searching >= limits.queued_jobs) return false;
  ++searching;
  return true;
}

/// Goes on with a job that has been enqueued.
void RenderService::State::proceed(const JobPointer& job) {
  if (needs_front_surface(job->picture.channels)) return search(job);
  wake.notify_one();
}

/// Goes on with a job that has waited for its model.
void RenderService::State::end_waiting(const JobPointer& job, const Status& there) {
  if (!there) return finish(job, fail(there.error()));
  bool room = false;
  {
    const std::lock_guard lock(mutex);
    job->since_submission = Stopwatch();
    room = !stopping && enqueue(*job);
  }
  if (room) return proceed(job);
  finish(job, busy_error());
}

JobId RenderService::State::add(SessionId session, PictureJob picture, PictureDone done) {
  const Status checked = check(picture);
  const auto job = std::make_shared<Job>();
  job->session = session;
  job->picture = std::move(picture);
  job->done = std::move(done);
  std::unique_lock lock(mutex);
  job->id = ++last_id;
  const bool waits = waits_for_model(job->picture);
  const bool room =
      checked && !stopping &&
      (waits ? await_model(job->id, job->picture.model, [this, job](const Status& there) { end_waiting(job, there); })
             : enqueue(*job));
  if (room) jobs.emplace(job->id, job);
  lock.unlock();
  if (!room) {
    job->done(checked ? busy_error() : fail(checked.error()));
  } else if (!waits) {
    proceed(job);
  }
  return job->id;
}

/// Finds what the channels of a picture need, before the picture waits for the render thread.
void RenderService::State::search(const JobPointer& job) {
  const PictureJob& picture = job->picture;
  const std::shared_ptr<const std::atomic<bool>> cancelled(job, &job->cancelled);
  picks->find_surface({picture.model, picture.request, picture.up_from_model, picture.channels}, cancelled,
                      [this, job](Result<std::vector<pick::FrontPixel>> front) { end_search(job, std::move(front)); });
}

void RenderService::State::end_search(const JobPointer& job, Result<std::vector<pick::FrontPixel>> front) {
  std::unique_lock lock(mutex);
  --searching;
  const bool wanted = front && !job->cancelled && !stopping;
  if (wanted) {
    job->front = std::move(*front);
    job->search_ms = job->since_submission.milliseconds();
    job->since_submission = Stopwatch();
    if (queue.push(job->session, job->id, job->picture.priority)) {
      lock.unlock();
      return wake.notify_one();
    }
  }
  lock.unlock();
  if (wanted) return finish(job, busy_error());
  finish(job, front ? cancelled_error() : fail(front.error()));
}

/// Keeps `proceed` until the model is there. False if there is no room.
bool RenderService::State::await_model(JobId job, const std::string& model, Proceed proceed) {
  if (awaiting.size() >= limits.queued_jobs) return false;
  awaiting.push_back({job, model, Stopwatch(), std::move(proceed)});
  return true;
}

/// Calls `proceed` at once, or, if the model is awaited, when it is there.
void RenderService::State::when_available(const std::string& model, const Proceed& proceed) {
  {
    const std::lock_guard lock(mutex);
    if (!stopping && models.awaited(model) && await_model(kNoJob, model, proceed)) return;
  }
  proceed({});
}

void RenderService::State::models_changed() {
  std::vector<Awaiting> there;
  std::vector<Awaiting> late;
  {
    const std::lock_guard lock(mutex);
    std::erase_if(awaiting, [&](Awaiting& entry) {
      const bool in_time = entry.since.milliseconds() <= static_cast<double>(limits.queue_timeout.count());
      const bool awaited = models.awaited(entry.model);
      if (awaited && in_time) return false;
      (awaited ? late : there).push_back(std::move(entry));
      return true;
    });
  }
  for (const Awaiting& entry : there) entry.proceed({});
  for (const Awaiting& entry : late) {
    entry.proceed(fail(ErrorKind::kUnavailable, "the model '" + entry.model + "' is being built"));
  }
}

void RenderService::State::finish(const JobPointer& job, Result<EncodedPicture> result) {
  {
    const std::lock_guard lock(mutex);
    if (jobs.erase(job->id) == 0) return;
  }
  job->done(std::move(result));
}

void RenderService::State::stop() {
  std::vector<JobPointer> waiting;
  std::vector<Awaiting> without_model;
  {
    const std::lock_guard lock(mutex);
    stopping = true;
    without_model = std::exchange(awaiting, {});
    for (const auto& [id, job] : jobs) job->cancelled = true;
    for (const Priority priority : {Priority::kMotion, Priority::kStill}) {
      while (const std::optional<JobId> id = queue.pop(priority)) waiting.push_back(jobs.at(*id));
    }
  }
  wake.notify_all();
  for (const JobPointer& job : waiting) finish(job, cancelled_error());
  for (const Awaiting& entry : without_model) entry.proceed(cancelled_error());
  if (render_thread.joinable()) render_thread.join();
  picks.reset();
  pool.reset();
  motion_pool.reset();
}

RenderService::RenderService(std::unique_ptr<State> state) : state_(std::move(state)) {}

Result<std::unique_ptr<RenderService>> RenderService::start(const ModelSource& models,
                                                            FrameRendererFactory make_renderer,
                                                            const ServiceLimits& limits) {
  auto state = std::make_unique<State>(models, limits);
  state->pool = std::make_unique<WorkerPool>(limits.encoders);
  state->motion_pool = std::make_unique<WorkerPool>(1);
  // Loads the codecs while the first picture is drawn. A failure is reported when the first picture is encoded.
  state->motion_pool->post([] { static_cast<void>(surfcast::encode::prepare_encoding()); });
  state->picks = std::make_unique<PickService>(models, limits.picks);
  std::promise<Status> promise;
  std::future<Status> started = promise.get_future();
  state->render_thread = std::jthread([raw = state.get(), make = std::move(make_renderer),
                                       made = std::move(promise)]() mutable { raw->run(make, std::move(made)); });
  if (Status status = started.get(); !status) return fail(status.error());
  return std::unique_ptr<RenderService>(new RenderService(std::move(state)));
}

RenderService::~RenderService() {
  state_->stop();
}

JobId RenderService::draw(SessionId session, PictureJob job, PictureDone done) {
  return state_->add(session, std::move(job), std::move(done));
}

bool RenderService::cancel(JobId id) {
  State::JobPointer waiting;
  {
    const std::lock_guard lock(state_->mutex);
    const auto found = state_->jobs.find(id);
    if (found == state_->jobs.end()) return false;
    found->second->cancelled = true;
    const bool awaits = std::erase_if(state_->awaiting, [id](const auto& entry) { return entry.job == id; }) > 0;
    if (awaits || state_->queue.remove(id)) waiting = found->second;
  }
  if (waiting) state_->finish(waiting, cancelled_error());
  return true;
}

JobId RenderService::encode(std::shared_ptr<const picture::Frame> frame, PictureJob picture, PictureDone done) {
  SURFCAST_EXPECTS(frame->image.format == picture::pixel_format_of(picture.format));
  const auto job = std::make_shared<State::Job>();
  job->picture = std::move(picture);
  job->picture.priority = Priority::kStill;
  job->done = std::move(done);
  {
    const std::lock_guard lock(state_->mutex);
    job->id = ++state_->last_id;
    state_->jobs.emplace(job->id, job);
    ++state_->in_encoding[static_cast<size_t>(Priority::kStill)];
  }
  state_->pool->post([state = state_.get(), job, frame = std::move(frame)]() mutable {
    state->encode_one(job, State::SharedFrame(std::move(frame)));
  });
  return job->id;
}

bool RenderService::replace(JobId id, PictureJob picture) {
  if (!state_->check(picture)) return false;
  const std::lock_guard lock(state_->mutex);
  if (!state_->queue.contains(id)) return false;
  SURFCAST_EXPECTS(state_->jobs.at(id)->picture.priority == picture.priority);
  state_->jobs.at(id)->picture = std::move(picture);
  return true;
}

void RenderService::models_changed() {
  state_->models_changed();
}

uint64_t RenderService::edition(const std::string& model) const {
  return state_->models.edition(model);
}

void RenderService::list_models(ListDone done) {
  state_->pool->post([state = state_.get(), done = std::move(done)] {
    done({state->models.names(), state->models.scans()});
  });
}

void RenderService::describe_model(const std::string& name, DescriptionDone done) {
  state_->when_available(name, [state = state_.get(), name, done = std::move(done)](const Status& there) {
    if (!there) return done(fail(there.error()));
    state->pool->post([state, name, done] { done(guarded([&] { return state->models.describe(name); })); });
  });
}

void RenderService::pick(PickJob job, PickService::Done done) {
  const std::string model = job.model;
  const auto run = [state = state_.get(), job = std::move(job), done = std::move(done)](const Status& there) {
    if (!there) return done(fail(there.error()));
    state->picks->pick(job, done);
  };
  state_->when_available(model, run);
}

void RenderService::profile(ProfileJob job, PickService::ProfileDone done) {
  const std::string model = job.model;
  const auto run = [state = state_.get(), job = std::move(job), done = std::move(done)](const Status& there) {
    if (!there) return done(fail(there.error()));
    state->picks->profile(job, done);
  };
  state_->when_available(model, run);
}

const picture::DeviceInfo& RenderService::device() const {
  return state_->device;
}

size_t RenderService::queued() const {
  const std::lock_guard lock(state_->mutex);
  return state_->queue.size();
}

}  // namespace surfcast::service
