// The render thread of RenderService: which picture is drawn next, and which ones are drawn in the middle of another.

#include <algorithm>
#include <chrono>
#include <utility>

#include "base/stopwatch.h"
#include "service/guarded.h"
#include "service/render_service_state.h"

namespace surfcast::service {

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

Result<picture::Frame> RenderService::State::render_frame(FrameRenderer& renderer, RenderJob& job,
                                                          const Preemption& preemption) {
  picture::PictureRequest request = job.picture.request;
  request.format = picture::pixel_format_of(job.picture.format);
  if (request.camera && job.picture.up_from_model) {
    const Result<ModelDescription> description = models.describe(job.picture.model);
    if (!description) return fail(description.error());
    request.camera->view_up = description->info.up();
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

}  // namespace surfcast::service
