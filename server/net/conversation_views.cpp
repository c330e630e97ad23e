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

}  // namespace

void Conversation::handle_open_view(const wire::Request& request) {
  const uint64_t id = request.id();
  const wire::OpenView& open_view = request.open_view();
  if (views_.contains(id)) {
    return send_error(id, {ErrorKind::kInvalidInput, "view " + std::to_string(id) + " is open already"});
  }
  if (const Status admitted = window_.admit(id); !admitted) return send_error(id, admitted.error());
  if (views_.size() >= context_->config.views) {
    return send_error(id, {ErrorKind::kUnavailable, "busy: too many views are open on this connection"});
  }
  if (std::string refusal = context_->clients->refusal_of_view(client_); !refusal.empty()) {
    return send_error(id, {ErrorKind::kUnavailable, std::move(refusal)});
  }
  if (const Status checked = protocol::check_view(open_view); !checked) return send_error(id, checked.error());
  Result<service::PictureJob> job = to_job(open_view.picture());
  if (!job) return send_error(id, job.error());
  const double fps = open_view.target_fps() > 0 ? open_view.target_fps() : context_->config.target_fps;
  const auto view =
      std::make_shared<view::ViewSession>(context_->service, session_, ++context_->last_viewer, fps,
                                          context_->metrics.views, port_of(id), context_->config.kept_frame_bytes);
  views_.emplace(id, OpenedView{view, open_view.picture().SerializeAsString(), open_view.picture().model(),
                                Counted(context_->clients, client_, &Clients::Counts::views)});
  view->update({0, std::move(*job), /*changed=*/true, /*moving=*/false}, Clock::now());
  advance_views();
}

void Conversation::handle_update_view(const wire::Request& request) {
  const wire::UpdateView& update = request.update_view();
  const auto found = views_.find(request.id());
  if (found == views_.end()) return;  // it may have ended while this was on its way
  if (update.picture().model() != found->second.model) {
    return end_view(request.id(), {ErrorKind::kInvalidInput, "a view stays with its model"});
  }
  const Status checked = protocol::check_view_picture(update.picture());
  if (!checked) return end_view(request.id(), checked.error());
  Result<service::PictureJob> job = to_job(update.picture());
  if (!job) return end_view(request.id(), job.error());
  std::string picture = update.picture().SerializeAsString();
  const bool changed = picture != found->second.picture;
  found->second.picture = std::move(picture);
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
  if (message.first) context_->metrics.count_stages(message.picture.stats);
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
