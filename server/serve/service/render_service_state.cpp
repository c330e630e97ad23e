// The jobs of RenderService outside its render thread: from the request to the queue, and from the frame to the client.

#include "service/render_service_state.h"

#include <algorithm>
#include <utility>

#include "base/host_memory.h"
#include "encode/encode_picture.h"
#include "service/guarded.h"
#include "service/picture_channels.h"

namespace surfcast::service {
namespace {

tl::unexpected<Error> busy_error() {
  return fail(ErrorKind::kUnavailable, "the server is busy: too many pictures wait");
}

}  // namespace

void RenderService::State::encode_one(const JobPointer& job, Result<SharedFrame> frame) {
  Result<EncodedPicture> result = guarded([&] { return encode_job(*job, frame); });
  if (result && job->picture.priority == Priority::kStill && job->picture.channels.none()) {
    const size_t pixels = static_cast<size_t>(result->width) * static_cast<size_t>(result->height);
    encode_times.record(result->format, pixels, result->encode_ms);
  }
  frame = cancelled_error();  // releases the pixels before the render thread may draw more
  if (const auto share = std::exchange(job->memory, nullptr); share && result) {
    share->shrink(result->bytes.size());
    result->memory = share;
  }
  if (result) count_kept_frame(*job, *result);
  {
    const std::lock_guard lock(mutex);
    --(job->small ? small_in_encoding : in_encoding[static_cast<size_t>(job->picture.priority)]);
  }
  wake.notify_one();
  finish(job, std::move(result));
}

/// The pixels of a kept frame count until it is released. It is not kept where they leave no room for another picture
/// like it: its client may hold it for as long as it answers nothing.
void RenderService::State::count_kept_frame(const RenderJob& job, EncodedPicture& picture) const {
  struct Kept {
    SharedFrame frame;
    std::shared_ptr<PictureMemory::Share> share;
  };
  const SharedFrame frame = std::exchange(picture.frame, nullptr);
  if (!frame) return;
  const size_t bytes = frame->image.pixels.size();
  if (!memory->fits(job.client.id, bytes + memory_of(job.picture))) return;
  const auto kept = std::make_shared<const Kept>(Kept{frame, memory->take(job.client.id, bytes)});
  picture.frame = {kept, kept->frame.get()};
}

size_t RenderService::State::picture_memory_limit(const ServiceLimits& limits) {
  constexpr size_t kMax = size_t{1} << 30;
  if (limits.picture_memory > 0) return limits.picture_memory;
  const uint64_t available = read_host_memory().available;
  return available == 0 ? kMax : std::min<size_t>(kMax, available / 4);
}

/// The render thread looks whether there is room now. Locking orders it behind a look that has just been taken.
void RenderService::State::look_again() {
  { const std::lock_guard lock(mutex); }
  wake.notify_one();
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
  return picture.request.loading == picture::Loading::kWait && models.awaited(picture.model.served_name());
}

/// Puts a job into the queue, or makes room for the search that precedes it. False if there is no room.
bool RenderService::State::enqueue(const RenderJob& job) {
  if (!needs_front_surface(job.picture.channels)) return queue.push(job.client, job.id, job.picture.priority);
  if (searching >= limits.queued_jobs) return false;
  ++searching;
  return true;
}

/// Goes on with a job that has been enqueued.
void RenderService::State::proceed(const JobPointer& job) {
  if (needs_front_surface(job->picture.channels)) {
    {
      const std::lock_guard lock(mutex);
      to_search.push_back(job);
    }
    start_searches();
  }
  wake.notify_one();
}

/// A job whose front surface may be looked for: there is memory for its picture.
std::vector<RenderService::State::JobPointer>::iterator RenderService::State::next_search() {
  return std::ranges::find_if(
      to_search, [this](const JobPointer& job) { return memory->fits(job->client.id, memory_of(job->picture)); });
}

/// Looks for the front surfaces for which there is memory: they take as much as the channels made of them.
void RenderService::State::start_searches() {
  for (;;) {
    JobPointer job;
    {
      const std::lock_guard lock(mutex);
      const auto next = stopping ? to_search.end() : next_search();
      if (next == to_search.end()) return;
      job = *next;
      to_search.erase(next);
      job->memory = memory->take(job->client.id, memory_of(job->picture));
    }
    search(job);
  }
}

/// Takes a job from those that wait for memory. False if it is not one of them.
bool RenderService::State::leave_searches(JobId id) {
  const bool waited = std::erase_if(to_search, [id](const JobPointer& job) { return job->id == id; }) > 0;
  if (waited) --searching;
  return waited;
}

/// Goes on with a job that has waited for its model.
void RenderService::State::end_waiting(const JobPointer& job, const Status& there) {
  if (!there) return finish(job, fail(there));
  bool room = false;
  {
    const std::lock_guard lock(mutex);
    job->since_submission = Stopwatch();
    room = !stopping && enqueue(*job);
  }
  if (room) return proceed(job);
  finish(job, busy_error());
}

JobId RenderService::State::add(const Client& client, PictureJob picture, PictureDone done) {
  const Status checked = check(picture);
  const auto job = std::make_shared<RenderJob>(client, std::move(picture), std::move(done));
  std::unique_lock lock(mutex);
  job->id = ++last_id;
  const bool waits = waits_for_model(job->picture);
  const bool room = checked && !stopping &&
                    (waits ? await_model(job->id, job->picture.model.served_name(),
                                         [this, job](const Status& there) { end_waiting(job, there); })
                           : enqueue(*job));
  if (room) jobs.emplace(job->id, job);
  lock.unlock();
  if (!room) {
    job->done(checked ? busy_error() : fail(checked));
  } else if (!waits) {
    proceed(job);
  }
  return job->id;
}

/// Finds what the channels of a picture need, before the picture waits for the render thread.
void RenderService::State::search(const JobPointer& job) {
  const PictureJob& picture = job->picture;
  const std::shared_ptr<const std::atomic<bool>> cancelled(job, &job->cancelled);
  picks->find_surface(
      {picture.model, picture.request, picture.up_from_model, picture.channels}, cancelled,
      [this, job](Result<std::vector<pick::FrontPixel>> front) { end_search(job, std::move(front)); }, job->client.id);
}

void RenderService::State::end_search(const JobPointer& job, Result<std::vector<pick::FrontPixel>> front) {
  std::unique_lock lock(mutex);
  --searching;
  const bool wanted = front && !job->cancelled && !stopping;
  if (wanted) {
    job->front = std::move(*front);
    job->search_ms = job->since_submission.milliseconds();
    job->since_submission = Stopwatch();
    if (queue.push(job->client, job->id, job->picture.priority)) {
      lock.unlock();
      return wake.notify_one();
    }
  }
  lock.unlock();
  if (wanted) return finish(job, busy_error());
  finish(job, front ? cancelled_error() : fail(front));
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
  deliver(job->done, std::move(result));
}

bool RenderService::State::cancel(JobId id) {
  JobPointer waiting;
  {
    const std::lock_guard lock(mutex);
    const auto found = jobs.find(id);
    if (found == jobs.end()) return false;
    found->second->cancelled = true;
    const bool awaits = std::erase_if(awaiting, [id](const auto& entry) { return entry.job == id; }) > 0;
    if (awaits || queue.remove(id) || leave_searches(id)) waiting = found->second;
  }
  if (waiting) finish(waiting, cancelled_error());
  return true;
}

void RenderService::State::stop() {
  std::vector<JobPointer> waiting;
  std::vector<Awaiting> without_model;
  {
    const std::lock_guard lock(mutex);
    stopping = true;
    without_model = std::exchange(awaiting, {});
    for (const auto& [id, job] : jobs) job->cancelled = true;
    waiting = std::exchange(to_search, {});
    for (const Priority priority : {Priority::kMotion, Priority::kStill}) {
      while (const std::optional<JobId> id = queue.pop(priority)) {
        waiting.push_back(jobs.at(*id));
        queue.shares().leave(waiting.back()->client.id);
      }
    }
  }
  wake.notify_all();
  for (const JobPointer& job : waiting) finish(job, cancelled_error());
  for (const Awaiting& entry : without_model) entry.proceed(cancelled_error());
  if (render_thread.joinable()) render_thread.join();
  picks.reset();
  lookups.reset();
  pool.reset();
  motion_pool.reset();
  memory->close();
}

Status RenderService::State::start_threads(FrameRendererFactory make_renderer,
                                           std::shared_ptr<PickService> shared_picks) {
  pool = std::make_unique<WorkerPool>(limits.encoders, /*small_threads=*/1);
  lookups = std::make_unique<WorkerPool>(1);
  motion_pool = std::make_unique<WorkerPool>(1);
  picks = std::move(shared_picks);
  std::promise<Status> promise;
  std::future<Status> started = promise.get_future();
  render_thread = std::jthread(
      [this, make = std::move(make_renderer), made = std::move(promise)]() mutable { run(make, std::move(made)); });
  return started.get();
}

bool RenderService::State::has(JobId id) const {
  const std::lock_guard lock(mutex);
  return jobs.contains(id);
}

size_t RenderService::State::queued() const {
  const std::lock_guard lock(mutex);
  return queue.size();
}

}  // namespace surfcast::service
