#include "view/view_plan.h"

#include <algorithm>
#include <limits>

namespace surfcast::view {

void ViewPlan::update(bool changed, bool moving, ViewTime now) {
  if (changed) {
    ++picture_;
    progress_ = Progress::kNone;
    changed_at_ = now;
    next_poll_at_ = now;
    improved_at_ = now;
    first_sample_.reset();
    drawn_ = false;
  }
  // Without a report of its end, a motion ends some time after its last update. With one, it ended at its last change.
  rest_at_ = moving ? now + timing_.grace : changed_at_;
}

const ViewPlan::Job* ViewPlan::find(uint64_t frame) const {
  const auto found = std::ranges::find(jobs_, frame, &Job::frame);
  return found == jobs_.end() ? nullptr : &*found;
}

/// One frame may be drawn while another is encoded or in flight, and as many more as the window allows. Frames at rest
/// that are in flight delay sending, but not drawing.
bool ViewPlan::room_for_motion() const {
  return jobs_.size() < kMaxUnacknowledged && jobs_.size() + motion_unacknowledged_ < window_;
}

FrameKind ViewPlan::wanted() const {
  if (progress_ == Progress::kNone) return FrameKind::kMotion;
  if (successor_ && progress_ >= Progress::kRefinedComplete) return FrameKind::kTakeover;
  return progress_ == Progress::kRefinedComplete ? FrameKind::kFinal : FrameKind::kRefined;
}

/// When the next frame of the picture is due.
std::optional<ViewTime> ViewPlan::due(ViewTime rest) const {
  if (wanted() == FrameKind::kTakeover) return std::max(rest + timing_.refined, next_poll_at_);
  switch (progress_) {
    case Progress::kNone:
      return next_poll_at_;
    case Progress::kMotion:
      return rest + timing_.refined;
    case Progress::kRefined:
      return std::max(rest + timing_.refined, next_poll_at_);
    case Progress::kRefinedComplete:
      return rest + timing_.final;
    case Progress::kFinal:
      break;
  }
  return std::nullopt;
}

ViewStep ViewPlan::next(ViewTime now) const {
  const bool under_way = std::ranges::any_of(jobs_, [this](const Job& job) { return job.picture == picture_; });
  if (under_way || sending_) return {};
  const FrameKind kind = wanted();
  if (kind == FrameKind::kMotion ? !room_for_motion() : !jobs_.empty() || !may_send()) return {};
  const std::optional<ViewTime> wanted_at = due(rest_at_);
  if (!wanted_at) return {};
  const ViewTime at = std::max(*wanted_at, not_before_);
  return at <= now ? ViewStep{kind, {}} : ViewStep{{}, at};
}

void ViewPlan::begin(uint64_t frame, FrameKind kind) {
  jobs_.push_back({frame, kind, picture_});
}

void ViewPlan::retarget(uint64_t frame) {
  for (Job& job : jobs_) {
    if (job.frame == frame) job.picture = picture_;
  }
}

std::optional<uint64_t> ViewPlan::retargetable() const {
  if (jobs_.empty()) return std::nullopt;
  const Job& last = jobs_.back();
  return last.kind == FrameKind::kMotion && last.picture != picture_ ? std::optional(last.frame) : std::nullopt;
}

std::vector<uint64_t> ViewPlan::outdated() const {
  std::vector<uint64_t> frames;
  for (const Job& job : jobs_) {
    if (job.kind != FrameKind::kMotion && job.picture != picture_) frames.push_back(job.frame);
  }
  return frames;
}

void ViewPlan::drop(uint64_t frame) {
  std::erase_if(jobs_, [frame](const Job& job) { return job.frame == frame; });
}

void ViewPlan::refuse(uint64_t frame, ViewTime now) {
  drop(frame);
  not_before_ = now + timing_.busy_retry;
}

bool ViewPlan::is_pending(uint64_t frame) const {
  return find(frame) != nullptr;
}

void ViewPlan::finish(uint64_t frame, FrameResult result, ViewTime now) {
  const Job* found = find(frame);
  if (found == nullptr) return;
  const Job job = *found;
  drop(frame);
  if (job.picture != picture_) return;
  next_poll_at_ = now + timing_.poll_interval;
  if (result == FrameResult::kImprovable) improved_at_ = now;
  switch (job.kind) {
    case FrameKind::kMotion:
      if (result != FrameResult::kNothing) progress_ = std::max(progress_, Progress::kMotion);
      break;
    case FrameKind::kRefined:
      progress_ = result == FrameResult::kComplete || now - improved_at_ > timing_.missing_block_timeout
                      ? Progress::kRefinedComplete
                      : Progress::kRefined;
      break;
    case FrameKind::kFinal:
      progress_ = Progress::kFinal;
      break;
    case FrameKind::kTakeover:
      if (result != FrameResult::kComplete) break;
      progress_ = Progress::kRefinedComplete;
      successor_ = false;
      break;
  }
}

void ViewPlan::record_draw(double draw_ms, uint32_t blocks, uint32_t missing, ViewTime now) {
  drawn_ = true;
  drawn_at_ = now;
  draw_ms_ = draw_ms;
  drawn_blocks_ = blocks;
  drawn_missing_ = missing;
}

void ViewPlan::record_missing(uint32_t missing, uint32_t blocks, ViewTime now) {
  if (!first_sample_) first_sample_ = last_sample_ = MissingSample{missing, blocks, now};
  if (missing < last_sample_.missing) improved_at_ = now;
  last_sample_ = {missing, blocks, now};
}

namespace {

/// Minimum pause between two frames at rest, in drawing times, so two thirds of the time are left for loading blocks.
/// The same time is the longest wait for the remaining blocks: drawing stalls loading, and takes longer the more it
/// shows.
constexpr double kPauses = 2;

}  // namespace

/// Before the first frame at rest, waits for all blocks until `final` after the start of rest. Waits longer if all
/// blocks will arrive soon at the rate measured so far, and for a while as long as most are missing: such a frame shows
/// little more than the one in motion, and drawing it delays the blocks.
uint32_t ViewPlan::max_missing_before_first_draw(ViewTime now) const {
  constexpr uint32_t kAny = std::numeric_limits<uint32_t>::max();
  if (now < rest_at_ + timing_.final || !first_sample_) return 0;
  const uint32_t half = last_sample_.blocks / 2;
  if (last_sample_.missing > half && now < rest_at_ + timing_.block_wait) return 0;
  if (last_sample_.missing >= first_sample_->missing) return kAny;
  const auto passed = last_sample_.at - first_sample_->at;
  const double to_come = static_cast<double>(last_sample_.missing) / (first_sample_->missing - last_sample_.missing);
  const auto whole_at = last_sample_.at + std::chrono::duration_cast<ViewTime::duration>(to_come * passed);
  const std::chrono::duration<double, std::milli> to_wait = whole_at - now;
  const double worth_ms = draw_ms_ > 0 ? kPauses * draw_ms_ : static_cast<double>(timing_.block_wait.count());
  return to_wait.count() <= worth_ms ? 0 : kAny;
}

/// The drawing time of the picture with all of its blocks. The last frame had fewer of them if it was a survey, or the
/// first one. Pixels take their share of the time whatever covers them, so few blocks are no small part of it.
double ViewPlan::whole_draw_ms() const {
  constexpr double kMost = 2;
  const double times = static_cast<double>(last_sample_.blocks) / std::max(drawn_blocks_, 1U);
  return draw_ms_ * std::clamp(times, 1.0, kMost);
}

uint32_t ViewPlan::max_missing_blocks(ViewTime now) const {
  if (!drawn_) return max_missing_before_first_draw(now);
  const uint32_t missing = last_sample_.missing;
  const double since_ms = std::chrono::duration<double, std::milli>(now - drawn_at_).count();
  const double worth_ms = kPauses * whole_draw_ms();
  if (since_ms < worth_ms) return 0;
  const double come = missing < drawn_missing_ ? drawn_missing_ - missing : 0;
  const bool rest_comes_soon = since_ms * missing < worth_ms * come;
  return rest_comes_soon ? 0 : drawn_missing_ - drawn_missing_ / 4;
}

void ViewPlan::send(FrameKind kind, bool last) {
  ++(kind == FrameKind::kMotion ? motion_unacknowledged_ : still_unacknowledged_);
  sending_ = !last;
}

void ViewPlan::acknowledge(FrameKind kind) {
  size_t& count = kind == FrameKind::kMotion ? motion_unacknowledged_ : still_unacknowledged_;
  count -= std::min<size_t>(count, 1);
}

}  // namespace surfcast::view
