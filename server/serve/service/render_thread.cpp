// The render thread of RenderService: which picture is drawn next, and which ones are drawn in the middle of another.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <utility>
#include <vector>

#include <malloc.h>

#include "base/stopwatch.h"
#include "encode/encode_picture.h"
#include "service/guarded.h"
#include "service/render_service_state.h"

namespace surfcast::service {
namespace {

tl::unexpected<Error> late_error() {
  return fail(ErrorKind::kUnavailable, "the server is busy: the picture waited too long");
}

/// Pictures of which each is drawn in the middle of the one before, the first of them not counted: as many as
/// residency::PageTable can have.
constexpr int kDeepest = 2;
/// What is left to drawing at least of a time that encoding takes all of, milliseconds: the fastest picture is drawn.
constexpr double kMinDrawingMs = 1;

}  // namespace

void RenderService::State::run(const FrameRendererFactory& make_renderer, std::promise<Status> started) {
  Result<std::unique_ptr<FrameRenderer>> renderer = guarded([&] { return make_renderer(); });
  if (!renderer) {
    started.set_value(fail(renderer));
    return;
  }
  device = (*renderer)->device();
  max_resolution = (*renderer)->max_resolution();
  started.set_value({});
  bool more_to_warm_up = true;
  for (;;) {
    if (more_to_warm_up && idle_for_a_moment()) {
      more_to_warm_up = warm_up(**renderer);
      if (!more_to_warm_up) ::malloc_trim(0);  // what large pictures have left goes back to the system
      continue;
    }
    const JobPointer job = next_job();
    if (!job) return;
    more_to_warm_up = true;  // there may be another model
    if (job->picture.priority == Priority::kMotion) {
      draw_motion(**renderer, job, /*depth=*/0, WaitingStills::kNone);
    } else {
      draw_still(**renderer, job, /*depth=*/0);
    }
  }
}

/// Does a step of the renderer's work for later, until a job can be drawn. False when no work remains.
bool RenderService::State::warm_up(FrameRenderer& renderer) {
  std::atomic<bool> wanted{false};
  const Preemption until_wanted(wanted, [&] {
    const std::lock_guard lock(mutex);
    wanted = stopping || next_priority();
    return false;
  });
  return guarded([&]() -> Result<bool> { return renderer.warm_up(until_wanted); }).value_or(false);
}

/// Waits for a moment. True if no job could be drawn meanwhile.
bool RenderService::State::idle_for_a_moment() {
  constexpr std::chrono::milliseconds kMoment{300};
  std::unique_lock lock(mutex);
  return !wake.wait_for(lock, kMoment, [this] { return stopping || next_priority(); });
}

WaitingStills RenderService::State::waiting_stills() const {
  const std::lock_guard lock(mutex);
  if (!queue.has_waiting(Priority::kStill)) return WaitingStills::kNone;
  const auto small = [this](JobId id) { return is_small(jobs.at(id)->picture); };
  return queue.next_client(Priority::kStill, small) ? WaitingStills::kSmall : WaitingStills::kLarge;
}

/// Whether a job may be drawn now: the encoders have room for its picture, and there is memory for it, or it has some.
/// Small pictures at rest take next to none, so that they do not wait for large ones to be encoded, sent and read.
bool RenderService::State::has_room(JobId id) const {
  const RenderJob& job = *jobs.at(id);
  if (job.picture.priority == Priority::kMotion) {
    return in_encoding[static_cast<size_t>(Priority::kMotion)] < limits.frames_in_encoding;
  }
  if (is_small(job.picture)) return small_in_encoding < limits.frames_in_encoding;
  return in_encoding[static_cast<size_t>(Priority::kStill)] < limits.frames_in_encoding &&
         (job.memory != nullptr || memory->fits(job.client.id, memory_of(job.picture)));
}

/// True if a job of this priority waits and has room.
bool RenderService::State::may_draw(Priority priority) const {
  return queue.next_client(priority, [this](JobId id) { return has_room(id); }).has_value();
}

/// Whether the next motion picture comes before a picture at rest of that client. Not if its own client is ahead: one
/// large motion picture takes as long as many small pictures at rest.
bool RenderService::State::moves_first(ClientId other) const {
  constexpr double kPatienceMs = 60;  // as in DrawShares
  const std::optional<ClientId> mover = queue.next_client(Priority::kMotion);
  return shares.motion_first() && mover && queue.shares().used(*mover) <= queue.shares().used(other) + kPatienceMs;
}

std::optional<Priority> RenderService::State::next_priority() const {
  const auto resting = queue.next_client(Priority::kStill, [this](JobId id) { return has_room(id); });
  if (may_draw(Priority::kMotion) && (!resting || moves_first(*resting))) return Priority::kMotion;
  return resting ? std::optional(Priority::kStill) : std::nullopt;
}

void RenderService::State::charge(const RenderJob& job, double milliseconds) {
  // A user who moves a view has three quarters of the time, as DrawShares gives to motion.
  const double weight = job.picture.priority == Priority::kMotion ? 1.0 / 3 : 1;
  const std::lock_guard lock(mutex);
  queue.shares().charge(job.client.id, weight * milliseconds);
}

/// A job that has left the queue does not count for its client any more.
void RenderService::State::leave_queue(const RenderJob& job) {
  const std::lock_guard lock(mutex);
  queue.shares().leave(job.client.id);
}

/// Takes a job that has left the queue. Null if the job has waited too long. It is then refused, because its client has
/// probably given up, and drawing it would delay other jobs past their own timeout.
RenderService::State::JobPointer RenderService::State::start(JobId id, std::unique_lock<std::mutex>& lock) {
  JobPointer job = jobs.at(id);
  job->waited_ms = job->since_submission.milliseconds();
  if (job->waited_ms <= static_cast<double>(limits.queue_timeout.count())) {
    const bool still = job->picture.priority == Priority::kStill;
    job->small = still && is_small(job->picture);
    ++(job->small ? small_in_encoding : in_encoding[static_cast<size_t>(job->picture.priority)]);
    if (still && job->memory == nullptr) job->memory = memory->take(job->client.id, memory_of(job->picture));
    return job;
  }
  queue.shares().leave(job->client.id);
  lock.unlock();
  finish(job, late_error());
  lock.lock();
  return nullptr;
}

/// Refuses the jobs that have waited too long for room.
void RenderService::State::refuse_late(std::unique_lock<std::mutex>& lock) {
  std::vector<JobPointer> late;
  for (const auto& [id, job] : jobs) {
    const bool waits = job->since_submission.milliseconds() > static_cast<double>(limits.queue_timeout.count());
    if (waits && (queue.remove(id) || leave_searches(id))) late.push_back(job);
  }
  lock.unlock();
  for (const JobPointer& job : late) {
    finish(job, late_error());
  }
  lock.lock();
}

/// Waits for a job that may be drawn; null if the service stops.
RenderService::State::JobPointer RenderService::State::next_job() {
  constexpr std::chrono::seconds kLookAgain{1};
  std::unique_lock lock(mutex);
  for (;;) {
    wake.wait(lock, [this] { return stopping || queue.size() > 0 || !to_search.empty(); });
    const auto searches = [this] { return next_search() != to_search.end(); };
    wake.wait_for(lock, kLookAgain, [&] { return stopping || next_priority() || searches(); });
    if (stopping) return nullptr;
    if (searches()) {
      lock.unlock();
      start_searches();
      lock.lock();
    }
    if (!next_priority()) {
      refuse_late(lock);
      continue;
    }
    const auto id = queue.pop(*next_priority(), [this](JobId job) { return has_room(job); });
    if (JobPointer job = start(*id, lock)) return job;
  }
}

/// The motion job that preempts the current still picture; null if there is none.
RenderService::State::JobPointer RenderService::State::next_motion(const RenderJob& current) {
  std::unique_lock lock(mutex);
  while (!stopping && may_draw(Priority::kMotion) && moves_first(current.client.id)) {
    if (JobPointer job = start(*queue.pop(Priority::kMotion), lock)) return job;
  }
  return nullptr;
}

/// The still job of another session that is drawn in the middle of the current one; null if there is none. In the
/// middle of a motion picture only a small one is drawn, and in the middle of one that is itself in the middle of
/// another only a much smaller one.
RenderService::State::JobPointer RenderService::State::next_still_of_others(const RenderJob& current, int depth) {
  const bool moves = current.picture.priority == Priority::kMotion;
  const size_t most = depth == 0 || moves ? SIZE_MAX : memory_of(current.picture) / 4;
  const auto accepts = [&](JobId id) {
    const PictureJob& picture = jobs.at(id)->picture;
    return has_room(id) && memory_of(picture) <= most && (!moves || is_small(picture));
  };
  std::unique_lock lock(mutex);
  while (!stopping && depth < kDeepest) {
    const std::optional<JobId> id = queue.pop_of_others(Priority::kStill, current.client, accepts);
    if (!id) return nullptr;
    if (JobPointer job = start(*id, lock)) return job;
  }
  return nullptr;
}

Result<picture::Frame> RenderService::State::render_frame(FrameRenderer& renderer, RenderJob& job,
                                                          const Preemption& preemption) {
  picture::PictureRequest request = job.picture.request;
  request.format = picture::pixel_format_of(job.picture.format);
  if (request.camera && job.picture.up_from_model) {
    const Result<ModelDescription> description = models.describe(job.picture.model.served_name());
    if (!description) return fail(description);
    request.camera->view_up = description->info.up();
  }
  if (request.time_ms > 0) {
    const Result<double> encoding = encoding_ms(renderer, job, request, preemption);
    if (!encoding) return fail(encoding);
    request.time_ms = std::max(request.time_ms - *encoding, kMinDrawingMs);
  }
  return renderer.draw(job.picture.model.served_name(), request, preemption);
}

/// How long the file of a picture takes to encode, as far as is known. Before the first one of a format a small, coarse
/// picture is encoded.
Result<double> RenderService::State::encoding_ms(FrameRenderer& renderer, const RenderJob& job,
                                                 picture::PictureRequest request, const Preemption& preemption) {
  constexpr int kSmaller = 4;
  constexpr double kCoarse = 4;  // pixels
  const size_t pixels = static_cast<size_t>(request.width) * static_cast<size_t>(request.height);
  const picture::FileFormat format = job.picture.format;
  if (const auto known = encode_times.expected_ms(format, pixels)) return *known;
  request.error = request.time_ms = 0;
  request.render_scale = 1;
  request.depth_texels = 0;
  request.spacing = kCoarse;
  request.width = std::max(request.width / kSmaller, 1);
  request.height = std::max(request.height / kSmaller, 1);
  const Result<picture::Frame> small = renderer.draw(job.picture.model.served_name(), request, preemption);
  if (!small) return fail(small);
  const Stopwatch watch;
  const auto file = encode::encode_picture(small->image, format, job.picture.quality);
  if (!file) return fail(file);
  encode_times.record(format, static_cast<size_t>(request.width) * static_cast<size_t>(request.height),
                      watch.milliseconds());
  return encode_times.expected_ms(format, pixels).value_or(0);
}

/// Draws a motion picture. If it takes longer than its turn, small still pictures of other sessions are drawn in its
/// middle, a turn apart, so that they do not wait for the largest of views. They are not interrupted. `unfinished`: the
/// pictures in whose middle it is drawn.
void RenderService::State::draw_motion(FrameRenderer& renderer, const JobPointer& job, int depth,
                                       WaitingStills unfinished) {
  const auto turn_ms = static_cast<double>(limits.motion_turn.count());
  Stopwatch since_others;
  const Preemption preemption(job->cancelled, [&] {
    if (since_others.milliseconds() < turn_ms) return false;
    const JobPointer other = next_still_of_others(*job, depth);
    if (other) draw_still(renderer, other, kDeepest);
    since_others = Stopwatch();
    return other != nullptr;
  });
  draw_one(renderer, job, preemption);
  charge(*job, job->draw_ms);
  leave_queue(*job);
  shares.drew_motion(job->draw_ms, std::max(unfinished, waiting_stills()));
}

bool RenderService::State::draw_waiting_motion(FrameRenderer& renderer, const RenderJob& current, int depth) {
  bool any = false;
  for (; const JobPointer motion = next_motion(current); any = true) {
    draw_motion(renderer, motion, depth, current.small ? WaitingStills::kSmall : WaitingStills::kLarge);
  }
  return any;
}

/// Draws a still picture, and motion pictures between its batches. If it takes long, still pictures of other sessions
/// are drawn in its middle, one after another. Between two of them it goes on for a turn, and at least for as long as
/// the one before took: each side has half of the time. The innermost one is small and is not interrupted.
void RenderService::State::draw_still(FrameRenderer& renderer, const JobPointer& job, int depth) {
  const auto turn_ms = static_cast<double>(limits.still_turn.count());
  double left_of_turn = turn_ms;
  Stopwatch since_others;
  const Preemption preemption(job->cancelled, [&] {
    const double drawn_ms = since_others.milliseconds();
    shares.drew_other(drawn_ms);
    charge(*job, drawn_ms);
    left_of_turn -= drawn_ms;
    bool preempted = depth < kDeepest && draw_waiting_motion(renderer, *job, depth + 1);
    const JobPointer other = left_of_turn <= 0 ? next_still_of_others(*job, depth) : nullptr;
    if (other) {
      const Stopwatch watch;
      draw_still(renderer, other, depth + 1);
      left_of_turn = std::max(turn_ms, watch.milliseconds());
      preempted = true;
    }
    since_others = Stopwatch();
    return preempted;
  });
  draw_one(renderer, job, preemption);
  shares.drew_other(since_others.milliseconds());
  charge(*job, since_others.milliseconds());
  leave_queue(*job);
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
    shared = fail(frame);
  }
  WorkerPool& encoder = job->picture.priority == Priority::kMotion ? *motion_pool : *pool;
  encoder.post([this, job, shared = std::move(shared)]() mutable { encode_one(job, std::move(shared)); },
               job->client.id, job->small ? TaskSize::kSmall : TaskSize::kLarge);
}

/// Cancels a picture that a newer one supersedes, if its encoding has not begun.
void RenderService::State::cancel_superseded(JobId id) {
  const std::lock_guard lock(mutex);
  const auto found = jobs.find(id);
  if (found != jobs.end() && !found->second->encoding) found->second->cancelled = true;
}

}  // namespace surfcast::service
