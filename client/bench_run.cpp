#include "client/bench_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <optional>

#include <poll.h>

#include "client/navigation.h"
#include "client/view.h"

namespace surfcast::client {
namespace {

using Clock = View::Clock;
using Seconds = std::chrono::duration<double>;

Clock::time_point after(Clock::time_point start, double seconds) {
  return start + std::chrono::duration_cast<Clock::duration>(Seconds(seconds));
}

double milliseconds_since(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double, std::milli>(end - start).count();
}

/// Waits until `end`; kCancelled if `interrupt` becomes readable first. A signal may end the wait early.
Status pause_until(Clock::time_point end, int interrupt) {
  pollfd watched{interrupt, POLLIN, 0};
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
  const int ready = ::poll(&watched, 1, static_cast<int>(std::clamp<long>(left, 0, 1 << 30)));
  return ready > 0 ? fail(ErrorKind::kCancelled, "interrupted") : Status();
}

/// The pose after `seconds` of movement. The camera turns around the model once in 12 seconds and smoothly changes its
/// distance.
Pose pose_on_path(const Pose& start, double seconds) {
  const double turn = 2 * std::numbers::pi * seconds / 12;
  const Pose around = orbit(start, {2 * seconds / 12, 0.03 * std::sin(3 * turn)});
  return zoom(around, 1 - 0.35 * std::sin(turn) * std::sin(turn), {0, 0});
}

double degrees_between(const Pose& a, const Pose& b) {
  const glm::dvec3 from = glm::normalize(a.focal_point - a.position);
  const glm::dvec3 to = glm::normalize(b.focal_point - b.position);
  return std::atan2(glm::length(glm::cross(from, to)), glm::dot(from, to)) * 180 / std::numbers::pi;
}

class BenchClient {
 public:
  BenchClient(const BenchPlan& plan, View& view, int interrupt, double phase)
      : plan_(plan), view_(view), interrupt_(interrupt), path_seconds_(12 * phase) {}

  Status run();
  BenchRecord take_record() { return std::move(record_); }

 private:
  Status begin();
  Status move();
  Status rest();
  Status send_update(double path_seconds, bool moving);
  Result<std::optional<BenchFrame>> receive(Clock::time_point deadline);
  [[nodiscard]] bool over() const { return Clock::now() >= end_; }
  [[nodiscard]] Pose pose_at(Clock::time_point time) const;

  const BenchPlan& plan_;
  View& view_;
  int interrupt_;
  double path_seconds_;
  Clock::time_point end_ = after(Clock::now(), plan_.seconds);
  Pose start_;
  std::optional<Clock::time_point> path_start_;  ///< while moving: when the client was at the beginning of the path
  uint64_t last_update_ = 0;
  std::map<uint64_t, Clock::time_point> sent_;  ///< send times of the updates that no frame has shown yet
  Clock::time_point shown_sent_;                ///< send time of the newest update that a frame has shown
  BenchRecord record_;
};

/// Where the client looks from.
Pose BenchClient::pose_at(Clock::time_point time) const {
  return pose_on_path(start_, path_start_ ? Seconds(time - *path_start_).count() : path_seconds_);
}

/// Waits for the first frame, which states the initial camera.
Status BenchClient::begin() {
  const Result<std::optional<View::Frame>> first = view_.next_until(after(Clock::now(), 60));
  if (!first) return fail(first);
  if (!*first) return fail(ErrorKind::kUnavailable, "no frame came within a minute");
  start_ = to_pose((*first)->frame.picture().camera());
  end_ = after(Clock::now(), plan_.seconds);
  return view_.painted(**first);
}

Status BenchClient::send_update(double path_seconds, bool moving) {
  wire::DrawPicture picture = plan_.picture;
  *picture.mutable_camera() = to_camera(pose_on_path(start_, path_seconds));
  const Clock::time_point now = Clock::now();
  const Result<uint64_t> update = view_.show(picture, moving);
  if (!update) return fail(update);
  last_update_ = *update;
  sent_[*update] = now;
  if (moving) ++record_.updates;
  return {};
}

Result<std::optional<BenchFrame>> BenchClient::receive(Clock::time_point deadline) {
  if (!plan_.reads) {
    if (Status status = pause_until(deadline, interrupt_); !status) return fail(status);
    return std::nullopt;
  }
  const Result<std::optional<View::Frame>> received = view_.next_until(deadline);
  if (!received) return fail(received);
  if (!*received) return std::nullopt;
  const wire::ViewFrame& message = (*received)->frame;
  const wire::Picture& picture = message.picture();
  if (Status status = view_.painted(**received); !status) return fail(status);
  if (const auto found = sent_.find(message.update()); found != sent_.end()) {
    shown_sent_ = found->second;
    sent_.erase(sent_.begin(), std::next(found));
  }
  BenchFrame frame;
  frame.moving = message.moving();
  frame.converged = !message.moving() && picture.converged() && picture.format() == plan_.picture.format() &&
                    message.update() == last_update_;
  frame.latency_ms = milliseconds_since(shown_sent_, (*received)->arrived);
  frame.turned = degrees_between(to_pose(picture.camera()), pose_at((*received)->arrived));
  frame.depth_bytes = message.depth().codes().size();
  frame.video = message.has_video();
  frame.bytes = (*received)->bytes;
  frame.width = picture.resolution().width();
  frame.spacing = picture.spacing();
  for (const wire::Stage& stage : picture.stages()) frame.stages.emplace_back(stage.name(), stage.milliseconds());
  return frame;
}

Status BenchClient::move() {
  const Clock::time_point start = Clock::now();
  const Clock::time_point stop = std::min(after(start, plan_.move_seconds), end_);
  Clock::time_point next_update = start;
  path_start_ = after(start, -path_seconds_);
  while (Clock::now() < stop) {
    if (Clock::now() >= next_update) {
      path_seconds_ = Seconds(Clock::now() - *path_start_).count();
      if (Status status = send_update(path_seconds_, true); !status) return status;
      next_update = std::max(after(next_update, 1 / plan_.updates_per_second), Clock::now());
    }
    Result<std::optional<BenchFrame>> frame = receive(std::min(next_update, stop));
    if (!frame) return fail(frame);
    if (*frame) record_.frames.push_back(std::move(**frame));
  }
  record_.moving_seconds += Seconds(Clock::now() - start).count();
  return {};
}

Status BenchClient::rest() {
  path_start_.reset();
  if (Status status = send_update(path_seconds_, false); !status) return status;
  const Clock::time_point stop = after(Clock::now(), plan_.rest_seconds);
  bool converged = false;
  Clock::time_point quiet_until = stop;
  while (Clock::now() < quiet_until) {
    Result<std::optional<BenchFrame>> frame = receive(quiet_until);
    if (!frame) return fail(frame);
    if (!*frame) continue;
    if (converged) ++record_.late;
    if (!converged && (*frame)->converged) {
      converged = true;
      quiet_until = std::min(stop, after(Clock::now(), 0.5));
    }
    record_.frames.push_back(std::move(**frame));
  }
  if (!converged && plan_.reads) ++record_.unconverged;
  return {};
}

Status BenchClient::run() {
  if (Status status = begin(); !status) return status;
  while (!over()) {
    if (Status status = move(); !status) return status;
    if (Status status = rest(); !status) return status;
  }
  record_.abandoned = view_.abandoned();
  return {};
}

}  // namespace

Result<BenchRecord> run_bench_client(const BenchPlan& plan, const ClientConfig& config, double phase) {
  Result<ServerConnection> connection = ServerConnection::open(plan.server, config);
  if (!connection) return fail(connection);
  Result<View> view = View::open(*connection, plan.picture, {plan.target_fps, plan.depth, plan.video});
  if (!view) return fail(view);
  BenchClient client(plan, *view, config.interrupt, phase);
  if (Status status = client.run(); !status) return fail(status);
  BenchRecord record = client.take_record();
  record.bytes = connection->bytes_received();
  return record;
}

}  // namespace surfcast::client
