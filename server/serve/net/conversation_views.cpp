// The part of a conversation that is about views.
#include <algorithm>
#include <boost/asio/post.hpp>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "net/conversation.h"
#include "net/convert.h"
#include "net/share_across_threads.h"
#include "protocol/validate.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;

/// What a view is asked to show, without an update.
KeptView kept_view(uint64_t id, const wire::OpenView& asked) {
  KeptView view;
  view.id = id;
  view.picture = asked.picture().SerializeAsString();
  view.target_fps = asked.target_fps();
  view.depth = asked.depth();
  view.video = std::ranges::count(asked.video(), wire::VIDEO_CODEC_VP9) > 0;
  return view;
}

}  // namespace

void Conversation::handle_open_view(const wire::Request& request) {
  const wire::OpenView& asked = request.open_view();
  Status opened = protocol::check_view(asked);
  if (opened) opened = open_view(kept_view(request.id(), asked));
  if (!opened) return send_error(request.id(), opened.error());
  advance_views();
}

Status Conversation::check_room_for_view(uint64_t id) const {
  if (views_.contains(id)) return fail(ErrorKind::kInvalidInput, "view " + std::to_string(id) + " is open already");
  if (Status admitted = window_.admit(id); !admitted) return admitted;
  if (views_.size() >= context_->config.views) {
    return fail(ErrorKind::kUnavailable, "busy: too many views are open on this connection");
  }
  std::string refusal = refusal_of_view();
  return refusal.empty() ? Status() : fail(ErrorKind::kUnavailable, std::move(refusal));
}

/// Opens a view whose picture was checked.
Status Conversation::open_view(KeptView wanted) {
  if (Status room = check_room_for_view(wanted.id); !room) return room;
  wire::DrawPicture picture;
  picture.ParseFromString(wanted.picture);
  const access::AuthorizedModel model = rights().authorize(picture.model());
  Result<service::PictureJob> job = to_job(picture, model);
  if (!job) return fail(job);
  audit("view", model);
  const double fps = wanted.target_fps > 0 ? wanted.target_fps : context_->config.target_fps;
  const view::ViewOptions options{fps, wanted.depth, wanted.video, context_->config.kept_frame_bytes};
  const auto view = std::make_shared<view::ViewSession>(context_->service, client_, model, ++context_->last_viewer,
                                                        options, context_->metrics.views, port_of(wanted.id));
  view->begin_with(wanted.quality);
  view->update({wanted.update, std::move(*job), /*changed=*/true, /*moving=*/false}, Clock::now());
  OpenedView opened{view, std::move(wanted), model, Counted(context_->clients, client_name_, &Clients::Counts::views),
                    context_->gate->count(user_, &Clients::Counts::views)};
  const uint64_t id = opened.wanted.id;
  views_.emplace(id, std::move(opened));
  return {};
}

/// The answer comes before the first frame of a view.
void Conversation::handle_resume(const wire::Request& request) {
  KeptSessions& sessions = context_->sessions;
  sessions.forget(session_);
  std::vector<KeptView> views = sessions.take(request.resume().session(), owner(), Clock::now());
  session_ = sessions.begin(weak_from_this(), owner(), client_name_);
  wire::Answer answer;
  answer.set_id(request.id());
  wire::Resumed& resumed = *answer.mutable_resumed();
  resumed.set_session(session_);
  resumed.set_seconds(std::chrono::duration<double>(sessions.time()).count());
  for (KeptView& view : views) {
    const uint64_t id = view.id;
    if (open_view(std::move(view))) resumed.add_views(id);
  }
  send(encode_answer(answer));
  advance_views();
}

std::vector<KeptView> Conversation::views_to_keep() const {
  std::vector<KeptView> kept;
  for (const auto& [id, opened] : views_) {
    kept.push_back(opened.wanted);
    kept.back().quality = opened.view->quality();
  }
  return kept;
}

/// The client has come over another connection: this one is as good as gone.
std::vector<KeptView> Conversation::hand_over() {
  session_.clear();
  std::vector<KeptView> views = views_to_keep();
  const auto writer = writer_;
  abandon();
  if (writer) writer->end(encode_error(0, {ErrorKind::kUnavailable, "the session goes on over another connection"}));
  return views;
}

/// Why there may not be another view; empty: there may.
std::string Conversation::refusal_of_view() const {
  std::string refusal = context_->gate->refusal_of_view(user_);
  return refusal.empty() ? context_->clients->refusal_of_view(client_name_) : refusal;
}

void Conversation::handle_update_view(const wire::Request& request) {
  const wire::UpdateView& update = request.update_view();
  const auto found = views_.find(request.id());
  if (found == views_.end()) return;  // it may have ended while this was on its way
  if (update.picture().model() != found->second.model.name()) {
    return end_view(request.id(), {ErrorKind::kInvalidInput, "a view stays with its model"});
  }
  const Status checked = protocol::check_view_picture(update.picture());
  if (!checked) return end_view(request.id(), checked.error());
  Result<service::PictureJob> job = to_job(update.picture(), found->second.model);
  if (!job) return end_view(request.id(), job.error());
  std::string picture = update.picture().SerializeAsString();
  const bool changed = picture != found->second.wanted.picture;
  found->second.wanted.picture = std::move(picture);
  found->second.wanted.update = update.update();
  found->second.view->update({update.update(), std::move(*job), changed, update.moving()}, Clock::now());
  advance_views();
}

void Conversation::handle_painted(const wire::Request& request) {
  constexpr double kLongest = 60'000;  // ms; beyond it a client is out of its mind
  const auto found = views_.find(request.id());
  if (found == views_.end()) return;
  const double ms = request.frame_painted().client_ms();
  const double client_ms = std::isfinite(ms) ? std::clamp(ms, 0.0, kLongest) : 0.0;
  found->second.view->acknowledge(request.frame_painted().frame(), client_ms, Clock::now());
  advance_views();
}

void Conversation::handle_close_view(const wire::Request& request) {
  const uint64_t id = request.close_view().view();
  const auto found = views_.find(id);
  if (found == views_.end()) {
    return send_error(request.id(), {ErrorKind::kNotFound, "there is no view " + std::to_string(id)});
  }
  found->second.view->close();
  views_.erase(found);
  wire::Answer answer;
  answer.set_id(request.id());
  answer.mutable_view_closed();
  send(encode_answer(answer));
}

view::ViewPort Conversation::port_of(uint64_t view) {
  const auto self = shared_from_this();
  view::ViewPort port;
  port.send = [self, view](view::ViewMessage message) { self->send_frame(view, std::move(message)); };
  port.fail = [self, view](const Error& error) { self->end_view(view, error); };
  port.may_draw = [self] {
    return self->writer_ && self->writer_->unread_bytes() <= self->context_->config.requests.outgoing_bytes;
  };
  port.post = [self = share_across_threads(self, executor_)](std::function<void()> task) {
    asio::post(self->executor_, [self, task = std::move(task)] {
      task();
      self->advance_views();
    });
  };
  return port;
}

void Conversation::send_frame(uint64_t view, view::ViewMessage message) {
  if (message.first) context_->metrics.count_stages(message.picture.stats, context_->metrics.view);
  wire::Answer answer;
  answer.set_id(view);
  to_wire(std::move(message), *answer.mutable_view_frame());
  send(encode_answer(answer));
}

void Conversation::end_view(uint64_t view, const Error& error) {
  const auto found = views_.find(view);
  if (found == views_.end()) return;
  found->second.view->close();
  views_.erase(found);
  send_error(view, error);
}

void Conversation::models_changed() {
  for (const auto& [id, opened] : views_) opened.view->model_changed();
  advance_views();
}

/// Lets every view do what is due, and waits for what is due later.
void Conversation::advance_views() {
  std::vector<std::shared_ptr<view::ViewSession>> views;
  views.reserve(views_.size());
  for (const auto& [id, opened] : views_) views.push_back(opened.view);
  std::optional<view::ViewTime> first;
  for (const auto& view : views) {
    const std::optional<view::ViewTime> next = view->advance(Clock::now());
    if (next) first = first ? std::min(*first, *next) : *next;
  }
  view_timer_.cancel();
  if (!first) return;
  view_timer_.expires_at(*first);
  view_timer_.async_wait([weak = weak_from_this()](const boost::system::error_code& code) {
    const auto self = weak.lock();
    if (self && !code) self->advance_views();
  });
}

}  // namespace surfcast::net
