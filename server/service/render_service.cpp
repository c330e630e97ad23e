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
#include "base/interruption.h"
#include "base/stopwatch.h"
#include "service/draw_shares.h"
#include "service/worker_pool.h"

namespace surfcast {
namespace {

tl::unexpected<Error> cancelled_error() {
  return fail(ErrorKind::kCancelled, "the request was cancelled");
}

/// Runs what may throw (memory runs out in a library) and makes a value of it, so that one job cannot end the server.
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
    PictureJob wish;
    PictureDone done;
    std::atomic<bool> cancelled = false;
    Stopwatch since_submission;
    double waited_ms = 0;  ///< for the render thread
    double draw_ms = 0;
    std::atomic<bool> encoding = false;  ///< has begun
  };
  using JobPointer = std::shared_ptr<Job>;
  using SharedFrame = std::shared_ptr<const Frame>;

  State(const ModelSource& source, const ServiceLimits& service_limits)
      : models(source), limits(service_limits), queue(service_limits.queued_jobs) {}

  // Render thread.
  void run(const PainterFactory& make_painter, std::promise<Status> started);
  [[nodiscard]] bool nobody_waits();
  [[nodiscard]] bool waits(Urgency urgency) const;
  [[nodiscard]] bool may_draw(Urgency urgency) const;
  [[nodiscard]] std::optional<Urgency> turn() const;
  JobPointer take(Urgency urgency, std::unique_lock<std::mutex>& lock);
  JobPointer next_job();
  JobPointer next_motion();
  Result<Frame> paint(Painter& painter, Job& job, const Interruption& interruption);
  void draw_one(Painter& painter, const JobPointer& job, const Interruption& interruption);
  void draw_motion(Painter& painter, const JobPointer& job, bool others_wait);
  void draw_patient(Painter& painter, const JobPointer& job);
  void give_up(JobId id);

  // Pool.
  static EncodedPicture describe(const Job& job, const Frame& frame);
  static Result<EncodedPicture> encode(Job& job, const Result<SharedFrame>& shared);
  void encode_one(const JobPointer& job, Result<SharedFrame> frame);

  // Any thread.
  [[nodiscard]] Status check(const PictureJob& wish) const;
  JobId add(SessionId session, PictureJob wish, PictureDone done);
  void finish(const JobPointer& job, Result<EncodedPicture> result);
  void stop();

  const ModelSource& models;
  const ServiceLimits limits;
  DrawShares shares;       ///< of the render thread
  DeviceInfo device;       ///< set before start() returns, constant afterwards
  int max_resolution = 0;  ///< likewise

  mutable std::mutex mutex;  ///< guards what follows
  std::condition_variable wake;
  JobQueue queue;
  std::map<JobId, JobPointer> jobs;  ///< outstanding: waiting, being drawn or being encoded
  JobId last_id = 0;
  std::array<size_t, 2> in_encoding{};  ///< drawn pictures and those being drawn, by urgency
  bool stopping = false;

  // Declared last, so that the threads end before what they use.
  std::unique_ptr<PickService> picks;
  std::unique_ptr<WorkerPool> pool;
  std::unique_ptr<WorkerPool> motion_pool;  ///< one thread
  std::jthread render_thread;
};

void RenderService::State::run(const PainterFactory& make_painter, std::promise<Status> started) {
  Result<std::unique_ptr<Painter>> painter = guarded([&] { return make_painter(); });
  if (!painter) {
    started.set_value(fail(painter.error()));
    return;
  }
  device = (*painter)->device();
  max_resolution = (*painter)->max_resolution();
  started.set_value({});
  bool more_to_rehearse = true;
  for (;;) {
    if (more_to_rehearse && nobody_waits()) {
      more_to_rehearse = guarded([&]() -> Result<bool> { return (*painter)->rehearse(); }).value_or(false);
      continue;
    }
    const JobPointer job = next_job();
    if (!job) return;
    more_to_rehearse = true;  // there may be another model
    if (job->wish.urgency == Urgency::kMotion) {
      draw_motion(**painter, job, waits(Urgency::kPatient));
    } else {
      draw_patient(**painter, job);
    }
  }
}

/// True once nothing has been to do for a moment.
bool RenderService::State::nobody_waits() {
  constexpr std::chrono::milliseconds kMoment{300};
  std::unique_lock lock(mutex);
  return !wake.wait_for(lock, kMoment, [this] { return stopping || turn(); });
}

bool RenderService::State::waits(Urgency urgency) const {
  const std::lock_guard lock(mutex);
  return queue.waits(urgency);
}

/// Whether a job of that urgency waits and has room behind the painter.
bool RenderService::State::may_draw(Urgency urgency) const {
  return queue.waits(urgency) && in_encoding[static_cast<size_t>(urgency)] < limits.frames_in_encoding;
}

std::optional<Urgency> RenderService::State::turn() const {
  const bool patient = may_draw(Urgency::kPatient);
  if (may_draw(Urgency::kMotion) && (shares.motion_first() || !patient)) return Urgency::kMotion;
  return patient ? std::optional(Urgency::kPatient) : std::nullopt;
}

/// The next job of that urgency. Null if it has waited too long: it is refused, because whoever sent it has given up by
/// now, and drawing it would make others wait too long in turn.
RenderService::State::JobPointer RenderService::State::take(Urgency urgency, std::unique_lock<std::mutex>& lock) {
  JobPointer job = jobs.at(*queue.pop(urgency));
  job->waited_ms = job->since_submission.milliseconds();
  if (job->waited_ms <= static_cast<double>(limits.patience.count())) {
    ++in_encoding[static_cast<size_t>(urgency)];
    return job;
  }
  lock.unlock();
  finish(job, fail(ErrorKind::kUnavailable, "the server is busy: the picture waited too long"));
  lock.lock();
  return nullptr;
}

/// Waits for a job that may be drawn; null when the service stops.
RenderService::State::JobPointer RenderService::State::next_job() {
  std::unique_lock lock(mutex);
  for (;;) {
    wake.wait(lock, [this] { return stopping || turn(); });
    if (stopping) return nullptr;
    if (JobPointer job = take(*turn(), lock)) return job;
  }
}

/// What is to be drawn in the middle of a patient picture; null if nothing is.
RenderService::State::JobPointer RenderService::State::next_motion() {
  std::unique_lock lock(mutex);
  while (!stopping && may_draw(Urgency::kMotion) && shares.motion_first()) {
    if (JobPointer job = take(Urgency::kMotion, lock)) return job;
  }
  return nullptr;
}

Result<Frame> RenderService::State::paint(Painter& painter, Job& job, const Interruption& interruption) {
  PictureRequest request = job.wish.request;
  request.format = pixel_format_of(job.wish.format);
  if (request.camera && job.wish.up_from_model) {
    const Result<ModelDescription> description = models.describe(job.wish.model);
    if (!description) return fail(description.error());
    request.camera->view_up = description->info.z_up ? glm::dvec3{0, 0, 1} : glm::dvec3{0, 1, 0};
  }
  return painter.draw(job.wish.model, request, interruption);
}

void RenderService::State::draw_motion(Painter& painter, const JobPointer& job, bool others_wait) {
  draw_one(painter, job, job->cancelled);
  shares.drew_motion(job->draw_ms, others_wait);
}

/// Draws a picture, and what motions wait for between its batches.
void RenderService::State::draw_patient(Painter& painter, const JobPointer& job) {
  Stopwatch since_motion;
  const Interruption interruption(job->cancelled, [&] {
    shares.drew_other(since_motion.milliseconds());
    bool disturbed = false;
    while (const JobPointer motion = next_motion()) {
      draw_motion(painter, motion, /*others_wait=*/true);
      disturbed = true;
    }
    since_motion = Stopwatch();
    return disturbed;
  });
  draw_one(painter, job, interruption);
  shares.drew_other(since_motion.milliseconds());
}

void RenderService::State::draw_one(Painter& painter, const JobPointer& job, const Interruption& interruption) {
  const WorkStopwatch watch(interruption);
  Result<Frame> frame = guarded([&] { return paint(painter, *job, interruption); });
  job->draw_ms = watch.milliseconds();
  Result<SharedFrame> shared = SharedFrame();
  if (frame) {
    frame->stats.stages.insert(frame->stats.stages.begin(), StageTime{"queue", job->waited_ms});
    give_up(job->wish.supersedes);
    shared = std::make_shared<const Frame>(std::move(*frame));
  } else {
    shared = fail(frame.error());
  }
  WorkerPool& encoder = job->wish.urgency == Urgency::kMotion ? *motion_pool : *pool;
  encoder.post([this, job, shared = std::move(shared)]() mutable { encode_one(job, std::move(shared)); });
}

/// Spares the encoders a picture that is overtaken by a newer one.
void RenderService::State::give_up(JobId id) {
  const std::lock_guard lock(mutex);
  const auto found = jobs.find(id);
  if (found != jobs.end() && !found->second->encoding) found->second->cancelled = true;
}

/// What a picture shows and what drawing it took; without its bytes.
EncodedPicture RenderService::State::describe(const Job& job, const Frame& frame) {
  EncodedPicture picture;
  picture.format = job.wish.format;
  picture.width = frame.image.width;
  picture.height = frame.image.height;
  picture.camera = frame.camera;
  picture.normalization = job.wish.request.normalization;
  picture.spacing = job.wish.request.spacing;
  picture.converged = frame.converged;
  picture.settled = frame.settled;
  picture.cut = frame.cut;
  picture.waited_ms = job.waited_ms;
  picture.draw_ms = job.draw_ms;
  picture.stats = frame.stats;
  return picture;
}

Result<EncodedPicture> RenderService::State::encode(Job& job, const Result<SharedFrame>& shared) {
  if (!shared) return fail(shared.error());
  job.encoding = true;
  if (job.cancelled) return cancelled_error();
  const Stopwatch watch;
  const Frame& frame = **shared;
  EncodedPicture picture = describe(job, frame);
  if (job.wish.keep_frame) picture.frame = *shared;
  if (!frame.image.pixels.empty()) {
    Result<std::vector<std::byte>> bytes = encode_picture(frame.image, job.wish.format, job.wish.quality);
    if (!bytes) return fail(bytes.error());
    picture.bytes = std::move(*bytes);
  }
  if (job.cancelled) return cancelled_error();
  picture.encode_ms = watch.milliseconds();
  picture.stats.stages.push_back({"encode", picture.encode_ms});
  return picture;
}

void RenderService::State::encode_one(const JobPointer& job, Result<SharedFrame> frame) {
  Result<EncodedPicture> result = guarded([&] { return encode(*job, frame); });
  frame = cancelled_error();  // lets go of the pixels before the render thread may make more
  {
    const std::lock_guard lock(mutex);
    --in_encoding[static_cast<size_t>(job->wish.urgency)];
  }
  wake.notify_one();
  finish(job, std::move(result));
}

Status RenderService::State::check(const PictureJob& wish) const {
  const int width = wish.request.width;
  const int height = wish.request.height;
  const std::string size = std::to_string(width) + "," + std::to_string(height);
  if (width < 1 || height < 1) return fail(ErrorKind::kInvalidInput, "resolution: must be at least 1,1");
  if (width > max_resolution || height > max_resolution) {
    return fail(ErrorKind::kLimit,
                "resolution: " + size + " is beyond " + std::to_string(max_resolution) + " pixels a side");
  }
  if (static_cast<size_t>(width) * static_cast<size_t>(height) > limits.pixels) {
    return fail(ErrorKind::kLimit,
                "resolution: " + size + " is more than " + std::to_string(limits.pixels) + " pixels");
  }
  return {};
}

JobId RenderService::State::add(SessionId session, PictureJob wish, PictureDone done) {
  const Status checked = check(wish);
  std::unique_lock lock(mutex);
  const JobId id = ++last_id;
  const bool room = checked && !stopping && queue.push(session, id, wish.urgency);
  if (room) {
    const auto job = std::make_shared<Job>();
    job->id = id;
    job->wish = std::move(wish);
    job->done = std::move(done);
    jobs.emplace(id, job);
    lock.unlock();
    wake.notify_one();
    return id;
  }
  lock.unlock();
  done(checked ? fail(ErrorKind::kUnavailable, "the server is busy: too many pictures wait") : fail(checked.error()));
  return id;
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
  {
    const std::lock_guard lock(mutex);
    stopping = true;
    for (const auto& [id, job] : jobs) job->cancelled = true;
    for (const Urgency urgency : {Urgency::kMotion, Urgency::kPatient}) {
      while (const std::optional<JobId> id = queue.pop(urgency)) waiting.push_back(jobs.at(*id));
    }
  }
  wake.notify_all();
  for (const JobPointer& job : waiting) finish(job, cancelled_error());
  if (render_thread.joinable()) render_thread.join();
  picks.reset();
  pool.reset();
  motion_pool.reset();
}

RenderService::RenderService(std::unique_ptr<State> state) : state_(std::move(state)) {}

Result<std::unique_ptr<RenderService>> RenderService::start(const ModelSource& models, PainterFactory make_painter,
                                                            const ServiceLimits& limits) {
  auto state = std::make_unique<State>(models, limits);
  state->pool = std::make_unique<WorkerPool>(limits.encoders);
  state->motion_pool = std::make_unique<WorkerPool>(1);
  state->picks = std::make_unique<PickService>(models);
  std::promise<Status> promise;
  std::future<Status> started = promise.get_future();
  state->render_thread = std::jthread([raw = state.get(), make = std::move(make_painter),
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
    if (state_->queue.remove(id)) waiting = found->second;
  }
  if (waiting) state_->finish(waiting, cancelled_error());
  return true;
}

JobId RenderService::encode(std::shared_ptr<const Frame> frame, PictureJob wish, PictureDone done) {
  SURFCAST_EXPECTS(frame->image.format == pixel_format_of(wish.format));
  const auto job = std::make_shared<State::Job>();
  job->wish = std::move(wish);
  job->wish.urgency = Urgency::kPatient;
  job->done = std::move(done);
  {
    const std::lock_guard lock(state_->mutex);
    job->id = ++state_->last_id;
    state_->jobs.emplace(job->id, job);
    ++state_->in_encoding[static_cast<size_t>(Urgency::kPatient)];
  }
  state_->pool->post([state = state_.get(), job, frame = std::move(frame)]() mutable {
    state->encode_one(job, State::SharedFrame(std::move(frame)));
  });
  return job->id;
}

bool RenderService::replace(JobId id, PictureJob wish) {
  if (!state_->check(wish)) return false;
  const std::lock_guard lock(state_->mutex);
  if (!state_->queue.contains(id)) return false;
  SURFCAST_EXPECTS(state_->jobs.at(id)->wish.urgency == wish.urgency);
  state_->jobs.at(id)->wish = std::move(wish);
  return true;
}

void RenderService::list_models(NamesDone done) {
  state_->pool->post([state = state_.get(), done = std::move(done)] { done(state->models.names()); });
}

void RenderService::describe_model(const std::string& name, DescriptionDone done) {
  state_->pool->post([state = state_.get(), name, done = std::move(done)] {
    done(guarded([&] { return state->models.describe(name); }));
  });
}

void RenderService::pick(PickJob job, PickService::Done done) {
  state_->picks->pick(std::move(job), std::move(done));
}

const DeviceInfo& RenderService::device() const {
  return state_->device;
}

size_t RenderService::queued() const {
  const std::lock_guard lock(state_->mutex);
  return state_->queue.size();
}

}  // namespace surfcast
