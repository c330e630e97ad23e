#include "net/conversation.h"

#include <boost/asio/post.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "net/convert.h"
#include "net/share_across_threads.h"
#include "protocol/framing.h"

namespace surfcast::net {

namespace asio = boost::asio;

Conversation::Conversation(std::shared_ptr<NetContext> context, service::SessionId session,
                           asio::any_io_executor executor, std::shared_ptr<AnswerWriter> writer, std::string client)
    : context_(std::move(context)),
      session_(session),
      client_(std::move(client)),
      executor_(std::move(executor)),
      writer_(std::move(writer)),
      window_(context_->config.requests),
      view_timer_(executor_) {}

Status Conversation::receive(std::span<const std::byte> message) {
  wire::Request request;
  if (Status decoded = protocol::decode_message(message, request); !decoded) return decoded;
  handle(request);
  return {};
}

void Conversation::handle(const wire::Request& request) {
  ++context_->metrics.requests;
  if (context_->draining) return send_error(request.id(), {ErrorKind::kUnavailable, "the server is stopping"});
  switch (request.kind_case()) {
    case wire::Request::kDrawPicture:
      return handle_picture(request);
    case wire::Request::kListModels:
    case wire::Request::kDescribeModel:
      return handle_other(request);
    case wire::Request::kPickSurfel:
      return handle_pick(request);
    case wire::Request::kGetProfile:
      return handle_profile(request);
    case wire::Request::kCancel:
      return handle_cancel(request);
    case wire::Request::kOpenView:
      return handle_open_view(request);
    case wire::Request::kUpdateView:
      return handle_update_view(request);
    case wire::Request::kFramePainted:
      return handle_painted(request);
    case wire::Request::kCloseView:
      return handle_close_view(request);
    case wire::Request::kPing: {
      wire::Answer answer;
      answer.set_id(request.id());
      answer.mutable_pong();
      return send(encode_answer(answer));
    }
    default:
      break;
  }
  send_error(request.id(), {ErrorKind::kUnsupported, "this server does not know that kind of request"});
}

void Conversation::handle_picture(const wire::Request& request) {
  if (const Status admitted = window_.admit(request.id()); !admitted) {
    return send_error(request.id(), admitted.error());
  }
  Result<service::PictureJob> job = to_job(request.draw_picture());
  if (!job) return send_error(request.id(), job.error());
  window_.add_picture(request.id(), std::move(*job));
  draw_next();
}

/// Gives the service what it may have of this client's requests.
void Conversation::draw_next() {
  while (writer_) {
    auto next = window_.next(writer_->unread_bytes());
    if (!next) return;
    const uint64_t id = next->first;
    const service::JobId job = context_->service.draw(
        session_, std::move(next->second), [later = answer_later(id), id](Result<service::EncodedPicture> picture) {
          later(outcome_of(id, std::move(picture)));
        });
    window_.set_job(id, job);
  }
}

void Conversation::handle_other(const wire::Request& request) {
  const uint64_t id = request.id();
  if (const Status admitted = window_.admit(id); !admitted) return send_error(id, admitted.error());
  window_.add_other(id);
  if (request.has_list_models()) {
    return context_->service.list_models(
        [later = answer_later(id), id, context = context_](const service::ModelList& models) {
          later(outcome_of(id, models, context->config.uploads));
        });
  }
  const std::string& name = request.describe_model().model();
  context_->service.describe_model(
      name, [later = answer_later(id), id, name](const Result<service::ModelDescription>& description) {
        later(outcome_of(id, name, description));
      });
}

void Conversation::handle_pick(const wire::Request& request) {
  const uint64_t id = request.id();
  if (const Status admitted = window_.admit(id); !admitted) return send_error(id, admitted.error());
  Result<service::PickJob> job = to_job(request.pick_surfel());
  if (!job) return send_error(id, job.error());
  window_.add_other(id);
  context_->service.pick(std::move(*job),
                         [later = answer_later(id), id](const Result<std::optional<kinds::PickedSurfel>>& picked) {
                           later(outcome_of(id, picked));
                         });
}

void Conversation::handle_profile(const wire::Request& request) {
  const uint64_t id = request.id();
  if (const Status admitted = window_.admit(id); !admitted) return send_error(id, admitted.error());
  Result<service::ProfileJob> job = to_job(request.get_profile());
  if (!job) return send_error(id, job.error());
  window_.add_other(id);
  context_->service.profile(std::move(*job),
                            [later = answer_later(id), id](const Result<service::ProfileResult>& profile) {
                              later(outcome_of(id, profile));
                            });
}

/// A function for any thread that hands an answer over to this object.
std::function<void(Outcome)> Conversation::answer_later(uint64_t id) {
  return [self = share_across_threads(shared_from_this(), executor_), id](Outcome outcome) {
    asio::post(self->executor_,
               [self, id, outcome = std::move(outcome)]() mutable { self->hand_over(id, std::move(outcome)); });
  };
}

void Conversation::hand_over(uint64_t id, Outcome outcome) {
  Metrics& metrics = context_->metrics;
  if (outcome.stats) metrics.count_picture(outcome.picture_bytes, *outcome.stats);
  if (outcome.failed) ++metrics.errors;
  window_.finish(id);
  send(std::move(outcome.answer));
  draw_next();
  if (writer_) writer_->answer_sent();
}

void Conversation::handle_cancel(const wire::Request& request) {
  const uint64_t target = request.cancel().request_id();
  const bool waited = window_.remove_waiting(target);
  if (waited) send_error(target, {ErrorKind::kCancelled, "the request was cancelled"});
  const std::optional<service::JobId> job = window_.job(target);
  wire::Answer answer;
  answer.set_id(request.id());
  answer.mutable_cancel_result()->set_was_outstanding(waited || (job && context_->service.cancel(*job)));
  send(encode_answer(answer));
}

void Conversation::send_error(uint64_t id, const Error& error) {
  ++context_->metrics.errors;
  send(encode_error(id, error));
}

void Conversation::send(Bytes answer) {
  if (writer_) writer_->send(std::move(answer));
}

void Conversation::resume_sending() {
  draw_next();
  advance_views();
}

void Conversation::abandon() {
  writer_.reset();
  for (const service::JobId job : window_.abandon()) context_->service.cancel(job);
  for (const auto& [id, opened] : views_) opened.view->close();
  views_.clear();
  view_timer_.cancel();
}

}  // namespace surfcast::net
