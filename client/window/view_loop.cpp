#include "client/window/view_loop.h"

#include <algorithm>
#include <chrono>
#include <glm/common.hpp>
#include <optional>
#include <string>
#include <thread>

#include "client/navigation.h"
#include "client/view.h"
#include "client/window/video_decoder.h"
#include "client/window/warped_view.h"
#include "client/window/window.h"

namespace surfcast::window {
namespace {

using Clock = client::View::Clock;
using std::chrono::milliseconds;

constexpr milliseconds kTick{8};          // between polls of the input
constexpr milliseconds kUpdateEvery{16};  // least time between two updates
constexpr milliseconds kRetryEvery{1000};
constexpr double kFlightPart = 0.06;  // flight speed: share of the model's diagonal per second

Subject subject_of(const wire::ModelDescription& model) {
  return {{client::vector_of(model.bounds().min()), client::vector_of(model.bounds().max())},
          model.z_up(),
          model.upside_down()};
}

/// Counts frames in intervals of one second; `last` is the count of the last complete interval.
class FrameRate {
 public:
  void count(Clock::time_point now) {
    if (now - since_ > milliseconds(1000)) {
      last_ = frames_;
      frames_ = 0;
      since_ = now;
    }
    ++frames_;
  }
  [[nodiscard]] int last() const { return last_; }

 private:
  Clock::time_point since_ = Clock::now();
  int frames_ = 0;
  int last_ = 0;
};

class ViewLoop {
 public:
  ViewLoop(const ViewRequest& request, const client::ClientConfig& config, Window& window)
      : request_(request), config_(config), window_(window), shown_(request.picture.background()) {}

  /// Connects and runs the view until the window is closed. An error when the connection fails.
  Status poll_input();
  /// Keeps the window responsive until the next attempt to connect. False when the window is closed.
  bool wait_for_server(const std::string& why);
  [[nodiscard]] bool was_connected() const { return controls_.has_value(); }

 private:
  Status open_view(client::ServerConnection& connection);
  Status begin_view(client::ServerConnection& connection);
  Status reopen_without_video(client::ServerConnection& connection);
  Status step(client::View& view);
  Status send_update(client::View& view, bool moving);
  Status focus(client::View& view);
  Status receive(client::View& view);
  Status take(client::View& view, const client::View::Frame& frame);
  Status paint();
  [[nodiscard]] wire::DrawPicture picture() const;
  [[nodiscard]] bool resized() const { return sent_width_ != window_.width() || sent_height_ != window_.height(); }

  const ViewRequest& request_;
  const client::ClientConfig& config_;
  Window& window_;
  std::optional<Controls> controls_;  ///< set with the first frame, which states the camera
  std::string session_;               ///< of the last connection
  std::optional<client::View> view_;  ///< its connection is gone while there is none
  Subject subject_;
  bool open_ = true;
  bool sent_moving_ = false;
  wire::Camera sent_camera_;
  int sent_width_ = 0;
  int sent_height_ = 0;
  Clock::time_point last_update_ = Clock::now();
  Clock::time_point last_turn_ = Clock::now();
  VideoDecoder video_;
  bool video_wanted_ = true;
  bool undecodable_ = false;  ///< a packet of the video
  WarpedView shown_;
  bool arrived_ = false;         ///< a frame that has not been shown
  uint64_t rest_shown_ = 0;      ///< the frame at rest that is shown; 0: one in motion
  wire::Camera painted_camera_;  ///< what is on the screen was painted for it
  FrameRate rate_;
};

wire::DrawPicture ViewLoop::picture() const {
  wire::DrawPicture picture = request_.picture;
  picture.mutable_resolution()->set_width(static_cast<uint32_t>(window_.width()));
  picture.mutable_resolution()->set_height(static_cast<uint32_t>(window_.height()));
  if (controls_) *picture.mutable_camera() = client::to_camera(controls_->pose());
  return picture;
}

Status ViewLoop::poll_input() {
  Result<client::ServerConnection> connection = client::ServerConnection::open(request_.url.server, config_);
  if (!connection) return fail(connection);
  if (Status status = open_view(*connection); !status) return status;
  while (open_) {
    if (Status status = step(*view_); !status) return status;
    if (!undecodable_) continue;
    if (Status status = reopen_without_video(*connection); !status) return status;
  }
  return {};
}

/// The server's video cannot be decoded: frames in motion are files from now on.
Status ViewLoop::reopen_without_video(client::ServerConnection& connection) {
  undecodable_ = false;
  video_wanted_ = false;
  if (Status status = view_->close(); !status) return status;
  return begin_view(connection);
}

Status ViewLoop::begin_view(client::ServerConnection& connection) {
  video_ = VideoDecoder();
  rest_shown_ = 0;
  const client::ViewWishes wishes{request_.target_fps, /*depth=*/true, video_wanted_, /*early=*/true};
  Result<client::View> view = client::View::open(connection, picture(), wishes);
  if (!view) return fail(view);
  view_.emplace(std::move(*view));
  return {};
}

/// Goes on with the view of the former connection if the server has kept it.
Status ViewLoop::open_view(client::ServerConnection& connection) {
  Result<wire::Resumed> resumed = connection.resume(session_);
  if (!resumed) return fail(resumed);
  session_ = resumed->session();
  const auto& views = resumed->views();
  if (view_ && std::find(views.begin(), views.end(), view_->id()) != views.end()) {
    view_->go_on(connection);
    return send_update(*view_, sent_moving_);
  }
  wire::Request describe;
  describe.mutable_describe_model()->set_model(request_.url.model);
  const Result<wire::Answer> answer = connection.ask(std::move(describe));
  if (!answer) return fail(answer);
  subject_ = subject_of(answer->model_description());
  sent_width_ = window_.width();
  sent_height_ = window_.height();
  return begin_view(connection);
}

Status ViewLoop::step(client::View& view) {
  const Clock::time_point now = Clock::now();
  const std::chrono::duration<double> passed = now - std::exchange(last_turn_, now);
  if (controls_) {
    open_ = window_.take_events(*controls_);
    controls_->advance(passed.count(), kFlightPart * subject_.bounds.diagonal());
    const bool moving = controls_->moving();
    const bool changed = client::to_camera(controls_->pose()).SerializeAsString() != sent_camera_.SerializeAsString();
    const bool due = now - last_update_ >= kUpdateEvery;
    if (due && (changed || moving != sent_moving_ || resized())) {
      if (Status status = send_update(view, moving); !status) return status;
    }
  } else {
    Controls nobody{client::Pose{}, subject_};
    open_ = window_.take_events(nobody);
  }
  if (Status status = focus(view); !status) return status;
  if (Status status = receive(view); !status) return status;
  return paint();
}

/// Sends a pick request for a double click, and moves the view when its result arrives.
Status ViewLoop::focus(client::View& view) {
  if (!controls_) return {};
  if (const auto picked = view.take_picked(); picked && picked->hit()) {
    controls_->focus_on(client::vector_of(picked->position()));
  }
  const std::optional<glm::dvec2> request = controls_->take_focus_request();
  if (!request) return {};
  const glm::dvec2 size(window_.width(), window_.height());
  const glm::dvec2 pixel = glm::clamp(*request * size, glm::dvec2(0), size - 1.0);
  return view.pick(picture(), static_cast<uint32_t>(pixel.x), static_cast<uint32_t>(pixel.y));
}

Status ViewLoop::send_update(client::View& view, bool moving) {
  const wire::DrawPicture wanted = picture();
  sent_camera_ = wanted.camera();
  sent_width_ = static_cast<int>(wanted.resolution().width());
  sent_height_ = static_cast<int>(wanted.resolution().height());
  sent_moving_ = moving;
  last_update_ = Clock::now();
  const Result<uint64_t> update = view.show(wanted, moving);
  return update ? Status() : fail(update);
}

Status ViewLoop::receive(client::View& view) {
  const Result<std::optional<client::View::Frame>> frame = view.next_until(Clock::now() + kTick);
  if (!frame) return fail(frame);
  return *frame ? take(view, **frame) : Status();
}

/// Shows what is there of the present camera: the newest frame, or what frames are when they are warped to it.
Status ViewLoop::paint() {
  if (!controls_) return {};
  const wire::Camera camera = client::to_camera(controls_->pose());
  const bool turned = camera.SerializeAsString() != painted_camera_.SerializeAsString();
  if (!arrived_ && !turned) return {};
  arrived_ = false;
  painted_camera_ = camera;
  const std::optional<PixelImage> warped = shown_.seen_by(camera, window_.width(), window_.height());
  return window_.show(warped ? *warped : shown_.newest());
}

Status ViewLoop::take(client::View& view, const client::View::Frame& frame) {
  // Another frame at rest is sharper than this one so far.
  if (!frame.whole && rest_shown_ != 0 && rest_shown_ != frame.frame.frame()) return {};
  const wire::Picture& picture = frame.frame.picture();
  Result<PixelImage> image = decode_frame(frame.frame, video_);
  if (!image && frame.frame.has_video()) {
    undecodable_ = true;
    return view.painted(frame);
  }
  if (!image) return fail(image);
  const int width = image->width;
  const int height = image->height;
  if (!controls_) {
    controls_.emplace(client::to_pose(picture.camera()), subject_);
    sent_camera_ = client::to_camera(controls_->pose());
  }
  shown_.take(frame.frame, std::move(*image));
  arrived_ = true;
  rest_shown_ = frame.frame.moving() ? 0 : frame.frame.frame();
  if (Status status = paint(); !status) return status;
  if (Status status = view.painted(frame); !status) return status;
  if (frame.whole) rate_.count(frame.arrived);
  const std::string state = frame.frame.moving()  ? std::to_string(rate_.last()) + " frames/s"
                            : picture.converged() ? "sharp"
                                                  : "getting sharper";
  window_.set_title(request_.url.model + " - " + state + ", " + std::to_string(picture.surfels_drawn()) + " surfels, " +
                    std::to_string(width) + " x " + std::to_string(height));
  return {};
}

bool ViewLoop::wait_for_server(const std::string& why) {
  window_.set_title(request_.url.model + " - " + why + "; trying again");
  Controls nobody{client::Pose{}, subject_};
  const Clock::time_point until = Clock::now() + kRetryEvery;
  while (open_ && Clock::now() < until) {
    open_ = window_.take_events(controls_ ? *controls_ : nobody);
    std::this_thread::sleep_for(kTick);
  }
  return open_;
}

bool worth_trying_again(const Error& error) {
  return error.kind == ErrorKind::kIo || error.kind == ErrorKind::kUnavailable;
}

}  // namespace

Status view_in_window(const ViewRequest& request, const client::ClientConfig& config) {
  const wire::Resolution& size = request.picture.resolution();
  Result<Window> window =
      Window::open(request.url.model, static_cast<int>(size.width()), static_cast<int>(size.height()));
  if (!window) return fail(window);
  ViewLoop loop(request, config, *window);
  for (;;) {
    Status status = loop.poll_input();
    if (status || !loop.was_connected() || !worth_trying_again(status.error())) return status;
    if (!loop.wait_for_server(status.error().message)) return {};
  }
}

}  // namespace surfcast::window
