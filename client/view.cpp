#include "client/view.h"

#include <utility>

#include "client/jpeg_scans.h"
#include "protocol/errors.h"

namespace surfcast::client {

Result<View> View::open(ServerConnection& connection, const wire::DrawPicture& picture, const ViewWishes& wishes) {
  wire::Request request;
  *request.mutable_open_view()->mutable_picture() = picture;
  request.mutable_open_view()->set_target_fps(wishes.target_fps);
  request.mutable_open_view()->set_depth(wishes.depth);
  if (wishes.video) request.mutable_open_view()->add_video(wire::VIDEO_CODEC_VP9);
  const Result<uint64_t> id = connection.send(std::move(request));
  if (!id) return fail(id);
  View view(connection, *id, wishes.early);
  view.bytes_before_ = connection.bytes_received();
  return view;
}

void View::go_on(ServerConnection& connection) {
  connection_ = &connection;
  incomplete_.reset();
  bytes_before_ = connection.bytes_received();
  pick_.reset();
}

Result<uint64_t> View::show(const wire::DrawPicture& picture, bool moving) {
  wire::Request request;
  wire::UpdateView& update = *request.mutable_update_view();
  update.set_update(++updates_);
  *update.mutable_picture() = picture;
  update.set_moving(moving);
  if (Status status = connection_->send_as(id_, std::move(request)); !status) return fail(status);
  return updates_;
}

Status View::acknowledge(uint64_t frame, double client_ms) {
  wire::Request request;
  request.mutable_frame_painted()->set_frame(frame);
  request.mutable_frame_painted()->set_client_ms(client_ms);
  return connection_->send_as(id_, std::move(request));
}

/// What can be shown of the current frame and has not been yet.
std::optional<View::Frame> View::early_frame() {
  const wire::Picture& picture = incomplete_->picture();
  if (!early_ || picture.format() != wire::FILE_FORMAT_JPEG) return std::nullopt;
  const size_t shown = showable_bytes(picture.data());
  if (shown <= shown_) return std::nullopt;
  shown_ = shown;
  Frame frame{*incomplete_, Clock::now(), 0, /*whole=*/false};
  frame.frame.set_more(false);
  frame.frame.mutable_picture()->set_data(picture.data().substr(0, shown).append(kEndOfJpeg));
  return frame;
}

/// Adds a piece to the current frame; returns the frame once it is complete, or what can be shown of it.
Result<std::optional<View::Frame>> View::take(wire::ViewFrame piece) {
  const bool more = piece.more();
  if (incomplete_ && incomplete_->frame() != piece.frame()) {
    incomplete_.reset();
    ++abandoned_;
  }
  if (incomplete_) {
    incomplete_->mutable_picture()->mutable_data()->append(piece.picture().data());
  } else {
    incomplete_ = std::move(piece);
    shown_ = 0;
  }
  if (more) {
    if (Status status = acknowledge(incomplete_->frame(), 0); !status) return fail(status);
    return early_frame();
  }
  incomplete_->set_more(false);
  const uint64_t total = connection_->bytes_received();
  const uint64_t bytes = total - std::exchange(bytes_before_, total);
  return Frame{*std::exchange(incomplete_, std::nullopt), Clock::now(), bytes};
}

Result<std::optional<View::Frame>> View::next_until(Clock::time_point deadline) {
  for (;;) {
    Result<std::optional<wire::Answer>> answer = connection_->receive_until(deadline);
    if (!answer) return fail(answer);
    if (!*answer) return std::nullopt;
    wire::Answer& message = **answer;
    if (message.has_error() && (message.id() == id_ || message.id() == 0)) {
      const Error error = protocol::from_wire(message.error());
      return connection_->failed(error.kind, error.message);
    }
    if (message.has_pick_result() && message.id() == pick_) picked_ = message.pick_result();
    if (!message.has_view_frame() || message.id() != id_) continue;
    Result<std::optional<Frame>> frame = take(std::move(*message.mutable_view_frame()));
    if (!frame || frame->has_value()) return frame;
  }
}

Status View::painted(const Frame& frame) {
  if (!frame.whole) return {};  // its pieces have been acknowledged
  const std::chrono::duration<double, std::milli> took = Clock::now() - frame.arrived;
  return acknowledge(frame.frame.frame(), took.count());
}

Status View::pick(const wire::DrawPicture& picture, uint32_t x, uint32_t y) {
  wire::Request request;
  *request.mutable_pick_surfel()->mutable_picture() = picture;
  request.mutable_pick_surfel()->set_x(x);
  request.mutable_pick_surfel()->set_y(y);
  const Result<uint64_t> id = connection_->send(std::move(request));
  if (!id) return fail(id);
  pick_ = *id;
  return {};
}

Status View::close() {
  wire::Request request;
  request.mutable_close_view()->set_view(id_);
  const Result<wire::Answer> answer = connection_->ask(std::move(request));
  if (!answer) return fail(answer);
  return {};
}

}  // namespace surfcast::client
