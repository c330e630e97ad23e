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

namespace {

/// Requests of unknown kinds, one after another, that end a connection. A newer client asks once and takes the answer.
/// Not a setting: it is a matter of the protocol.
constexpr size_t kMaxUnknown = 3;

}  // namespace

Conversation::Conversation(std::shared_ptr<NetContext> context, const service::Client& client,
                           asio::any_io_executor executor, std::shared_ptr<AnswerWriter> writer, std::string name,
                           const Gatekeeper::User& user)
    : context_(std::move(context)),
      client_(client),
      client_name_(std::move(name)),
      executor_(std::move(executor)),
      writer_(std::move(writer)),
      window_(context_->config.requests),
      view_timer_(executor_) {
  if (user) welcome(user);
}

Status Conversation::receive(std::span<const std::byte> message) {
  if (!writer_) return {};  // it was told to leave
  wire::Request request;
  if (Status decoded = protocol::decode_message(message, request); !decoded) return decoded;
  unknown_ = request.kind_case() == wire::Request::KIND_NOT_SET ? unknown_ + 1 : 0;
  if (unknown_ >= kMaxUnknown) return fail(ErrorKind::kUnsupported, "these requests are of no kind that is known here");
  handle(request);
  return {};
}

void Conversation::handle(const wire::Request& request) {
  ++context_->metrics.requests;
  if (context_->draining || refusing_)
    return send_error(request.id(), {ErrorKind::kUnavailable, "the server is stopping"});
  if (request.has_ping()) return handle_ping(request);
  if (request.has_authenticate()) return handle_authenticate(request);
  if (!admitted()) return deny(request.id(), "this server wants a token first (surfcast login)");
  handle_admitted(request);
}

void Conversation::handle_admitted(const wire::Request& request) {
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
    case wire::Request::kGetPoints:
      return handle_points(request);
    case wire::Request::kCancel:
      return handle_cancel(request);
    case wire::Request::kResume:
      return handle_resume(request);
    case wire::Request::kOpenView:
      return handle_open_view(request);
    case wire::Request::kUpdateView:
      return handle_update_view(request);
    case wire::Request::kFramePainted:
      return handle_painted(request);
    case wire::Request::kCloseView:
      return handle_close_view(request);
    default:
      break;
  }
  send_error(request.id(), {ErrorKind::kUnsupported, "this server does not know that kind of request"});
}

void Conversation::handle_ping(const wire::Request& request) {
  wire::Answer answer;
  answer.set_id(request.id());
  answer.mutable_pong();
  send(encode_answer(answer));
}

void Conversation::handle_picture(const wire::Request& request) {
  if (const Status admitted = window_.admit(request.id()); !admitted) {
    return send_error(request.id(), admitted.error());
  }
  const wire::DrawPicture& picture = request.draw_picture();
  Result<service::PictureJob> job = to_job(picture, rights().authorize(picture.model()));
  if (!job) return send_error(request.id(), job.error());
  audit_once("picture", job->model);
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
        client_, std::move(next->second), [later = answer_later(id), id](Result<service::EncodedPicture> picture) {
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
        rights(),
        [later = answer_later(id), id, context = context_](const service::ModelList& models) {
          later(outcome_of(id, models, context->config.uploads));
        },
        client_.id);
  }
  const access::AuthorizedModel model = rights().authorize(request.describe_model().model());
  audit_once("describe", model);
  context_->service.describe_model(
      model,
      [later = answer_later(id), id, name = model.name()](const Result<service::ModelDescription>& description) {
        later(outcome_of(id, name, description));
      },
      client_.id);
}

void Conversation::handle_pick(const wire::Request& request) {
  const uint64_t id = request.id();
  if (const Status admitted = window_.admit(id); !admitted) return send_error(id, admitted.error());
  const wire::PickSurfel& pick = request.pick_surfel();
  Result<service::PickJob> job = to_job(pick, rights().authorize(pick.picture().model()));
  if (!job) return send_error(id, job.error());
  audit_once("pick", job->model);
  window_.add_other(id);
  context_->service.pick(
      std::move(*job),
      [later = answer_later(id), id](const Result<std::optional<service::PickedPoint>>& picked) {
        later(outcome_of(id, picked));
      },
      client_.id);
}

void Conversation::handle_profile(const wire::Request& request) {
  const uint64_t id = request.id();
  if (const Status admitted = window_.admit(id); !admitted) return send_error(id, admitted.error());
  Result<service::ProfileJob> job = to_job(request.get_profile(), rights().authorize(request.get_profile().model()));
  if (!job) return send_error(id, job.error());
  audit_once("profile", job->model);
  window_.add_other(id);
  context_->service.profile(
      std::move(*job),
      [later = answer_later(id), id](const Result<service::ProfileResult>& profile) { later(outcome_of(id, profile)); },
      client_.id);
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
  send(std::move(outcome.answer), std::move(outcome.memory));
  draw_next();
  if (writer_) writer_->answer_sent();
}

void Conversation::handle_cancel(const wire::Request& request) {
  const uint64_t target = request.cancel().request_id();
  const bool waited = window_.remove_waiting(target) || cancel_points(target);
  if (waited) send_error(target, {ErrorKind::kCancelled, "the request was cancelled"});
  const std::optional<service::JobId> job = window_.job(target);
  wire::Answer answer;
  answer.set_id(request.id());
  answer.mutable_cancel_result()->set_was_outstanding(waited || (job && context_->service.cancel(*job)));
  send(encode_answer(answer));
}

void Conversation::audit(std::string_view what, const access::AuthorizedModel& model) {
  if (!context_->audit) return;
  AuditEvent event = question_about(model, what);
  event.who = owner();
  event.client = client_name_;
  event.connection = client_.session;
  context_->audit->write(std::move(event));
}

/// A client that asks the same again and again makes one line.
void Conversation::audit_once(std::string_view what, const access::AuthorizedModel& model) {
  constexpr size_t kRemembered = 256;
  if (!context_->audit || !audited_.insert(std::string(what) + ' ' + model.name()).second) return;
  if (audited_.size() > kRemembered) audited_.clear();
  audit(what, model);
}

void Conversation::send_error(uint64_t id, const Error& error) {
  ++context_->metrics.errors;
  send(encode_error(id, error));
}

void Conversation::send(Bytes answer, std::shared_ptr<const void> memory) {
  if (writer_) writer_->send(std::move(answer), std::move(memory));
}

void Conversation::resume_sending() {
  draw_next();
  advance_points();
  advance_views();
}

void Conversation::abandon() {
  if (!session_.empty()) {
    context_->sessions.keep(std::exchange(session_, {}), views_to_keep(), KeptSessions::Clock::now());
  }
  writer_.reset();
  for (const service::JobId job : window_.abandon()) context_->service.cancel(job);
  for (const auto& [id, region] : regions_) *region.cancelled = true;
  regions_.clear();
  for (const auto& [id, opened] : views_) opened.view->close();
  views_.clear();
  view_timer_.cancel();
}

}  // namespace surfcast::net
