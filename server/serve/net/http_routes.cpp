#include "net/http_routes.h"

#include <atomic>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <chrono>
#include <utility>

#include "net/await_answer.h"
#include "net/convert.h"
#include "net/http_annotations.h"
#include "net/redirect_error_to.h"
#include "protocol/picture_query.h"
#include "protocol/points_query.h"
#include "protocol/profile_query.h"

namespace surfcast::net {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

/// Between two looks at a client that has sent more than one request. Not a setting: it bounds what is drawn in vain.
constexpr std::chrono::milliseconds kLookAgain{100};

}  // namespace

HttpRoutes::HttpRoutes(std::shared_ptr<NetContext> context, std::shared_ptr<HttpConnection> connection,
                       const service::Client& client)
    : context_(std::move(context)),
      connection_(std::move(connection)),
      client_(client),
      look_again_(connection_->stream().get_executor()) {}

void HttpRoutes::set_user(access::Rights rights, const service::Client& client) {
  rights_ = std::move(rights);
  client_ = client;
}

bool HttpRoutes::cancel() {
  return give_up_ && give_up_();
}

asio::awaitable<HttpAnswer> HttpRoutes::answer(ServerRoute route, const std::string& accept) {
  switch (route) {
    case ServerRoute::kPage:
      co_return no_viewer_answer();
    case ServerRoute::kModels:
      co_return co_await answer_models();
    case ServerRoute::kHealth:
      co_return text_answer("ok\n", "text/plain");
    case ServerRoute::kReady:
      if (context_->leaving) co_return error_answer({ErrorKind::kUnavailable, "the server is stopping"});
      co_return text_answer("ready\n", "text/plain");
    case ServerRoute::kMetrics:
    case ServerRoute::kLogin:      // answered already
    case ServerRoute::kLogout:     // answered already
    case ServerRoute::kWebSocket:  // answered already
      break;
  }
  co_return answer_metrics(accept);
}

asio::awaitable<HttpAnswer> HttpRoutes::answer(const ModelRoute& route, const access::AuthorizedModel& model) {
  switch (route.resource) {
    case ModelRoute::Resource::kPicture:
      return answer_picture(route.query, model);
    case ModelRoute::Resource::kPick:
      return answer_pick(route.query, model);
    case ModelRoute::Resource::kProfile:
      return answer_profile(route.query, model);
    case ModelRoute::Resource::kPoints:
      return answer_points(route.query, model);
    case ModelRoute::Resource::kAnnotations:
      return answer_annotations(*context_, model, rights_.authorize_annotations(model.name()).has_value(), client_.id);
    case ModelRoute::Resource::kDescription:
      break;
  }
  return answer_model(model);
}

HttpAnswer HttpRoutes::answer_metrics(const std::string& accept) const {
  const Exposition::Format format = exposition_format(accept);

  const Clients::Counts& open = context_->clients->all();
  const Gatekeeper& gate = *context_->gate;
  const auto& workers = context_->config.workers;
  const std::string text = metrics_text(context_->metrics,
                                        {.connections = open.connections + open.refused,
                                         .waiting = context_->sessions.waiting(KeptSessions::Clock::now()),
                                         .audit_lost = context_->audit ? context_->audit->lost() : 0,
                                         .audit_left_out = context_->audit ? context_->audit->left_out() : 0,
                                         .queued = context_->service.queued(),
                                         .picture_memory = context_->service.picture_memory(),
                                         .users = gate.connections(),
                                         .denied = gate.denied(),
                                         .memory = context_->service.memory(),
                                         .workers = workers ? std::optional(workers()) : std::nullopt},
                                        format);
  return text_answer(text, media_type(format));
}

asio::awaitable<HttpAnswer> HttpRoutes::answer_models() {
  const auto models = co_await answer_of<service::ModelList>(
      [this](auto done) { context_->service.list_models(rights_, std::move(done), client_.id); });
  co_return models_answer(models, context_->config.uploads);
}

asio::awaitable<HttpAnswer> HttpRoutes::answer_model(const access::AuthorizedModel& model) {
  const auto description = co_await answer_of<Result<service::ModelDescription>>(
      [&](auto done) { context_->service.describe_model(model, std::move(done), client_.id); });
  co_return description ? model_answer(model.name(), *description) : error_answer(description.error());
}

asio::awaitable<HttpAnswer> HttpRoutes::answer_pick(const std::string& query, const access::AuthorizedModel& model) {
  Result<service::PickJob> job =
      protocol::parse_pick_query(model.name(), query).and_then([&](const wire::PickSurfel& request) {
        return to_job(request, model);
      });
  if (!job) co_return error_answer(job.error());
  const auto picked = co_await answer_of<Result<std::optional<service::PickedPoint>>>(
      [&](auto done) { context_->service.pick(*job, std::move(done), client_.id); });
  co_return picked ? pick_answer(*picked) : error_answer(picked.error());
}

asio::awaitable<HttpAnswer> HttpRoutes::answer_profile(const std::string& query, const access::AuthorizedModel& model) {
  const Result<protocol::ProfileQuery> wanted = protocol::parse_profile_query(model.name(), query);
  if (!wanted) co_return error_answer(wanted.error());
  Result<service::ProfileJob> job = to_job(wanted->profile, model);
  if (!job) co_return error_answer(job.error());
  connection_->wait_without_limit();
  const auto profile = co_await answer_of<Result<service::ProfileResult>>(
      [&](auto done) { context_->service.profile(*job, std::move(done), client_.id); });
  co_return profile ? profile_answer(model.name(), *profile, wanted->format) : error_answer(profile.error());
}

asio::awaitable<HttpAnswer> HttpRoutes::answer_points(const std::string& query, const access::AuthorizedModel& model) {
  const Result<wire::GetPoints> request = protocol::parse_points_query(model.name(), query);
  if (!request) co_return error_answer(request.error());
  Result<service::PointsJob> job = to_job(*request, model);
  if (!job) co_return error_answer(job.error());
  auto stream = co_await count(std::move(*job));
  if (!stream) co_return error_answer(stream.error());
  const uint64_t points = (*stream)->facts().count;
  if (request->only_count()) co_return point_count_answer(points, (*stream)->most());
  HttpAnswer answer = points_answer(model.name(), protocol::name_of(request->format()), points);
  answer.more = [self = shared_from_this(), stream = std::move(*stream)] { return self->next_piece(stream); };
  co_return answer;
}

asio::awaitable<Result<std::shared_ptr<service::PointStream>>> HttpRoutes::count(service::PointsJob job) {
  using Stream = Result<std::shared_ptr<service::PointStream>>;
  connection_->wait_without_limit();
  const auto cancelled = std::make_shared<std::atomic<bool>>(false);
  begin_request([cancelled] { return !cancelled->exchange(true); });
  Stream stream = co_await answer_of<Stream>(
      [&](auto done) { context_->service.points(std::move(job), cancelled, std::move(done), client_.id); });
  end_request();
  co_return stream;
}

asio::awaitable<Result<service::PointPiece>> HttpRoutes::next_piece(std::shared_ptr<service::PointStream> stream) {
  if (connection_->has_left()) co_return fail(ErrorKind::kCancelled, "the client has left");
  connection_->wait_without_limit();
  Result<service::PointPiece> piece = co_await answer_of<Result<service::PointPiece>>(
      [&](auto done) { context_->service.next_piece(stream, std::move(done), client_.id); });
  co_return piece;
}

asio::awaitable<HttpAnswer> HttpRoutes::answer_picture(const std::string& query, const access::AuthorizedModel& model) {
  Result<service::PictureJob> job =
      protocol::parse_picture_query(model.name(), query).and_then([&](const wire::DrawPicture& request) {
        return to_job(request, model);
      });
  if (!job) co_return error_answer(job.error());
  Result<service::EncodedPicture> picture = co_await draw(std::move(*job));
  if (!picture) co_return error_answer(picture.error());
  context_->metrics.count_picture(picture->bytes.size(), picture->stats);
  co_return picture_answer(std::move(*picture));
}

asio::awaitable<Result<service::EncodedPicture>> HttpRoutes::draw(service::PictureJob job) {
  connection_->wait_without_limit();
  Result<service::EncodedPicture> picture = co_await answer_of<Result<service::EncodedPicture>>([&](auto done) {
    const service::JobId id = context_->service.draw(client_, std::move(job), std::move(done));
    begin_request([this, id] { return context_->service.cancel(id); });
  });
  end_request();
  co_return picture;
}

/// Something is done for the client from here on, which `give_up` ends.
void HttpRoutes::begin_request(std::function<bool()> give_up) {
  give_up_ = std::move(give_up);
  asio::co_spawn(
      connection_->stream().get_executor(),
      [](std::shared_ptr<HttpRoutes> self, uint64_t request) -> asio::awaitable<void> {
        co_await self->give_up_when_client_leaves(request);
      }(shared_from_this(), ++request_),
      asio::detached);
}

void HttpRoutes::end_request() {
  give_up_ = nullptr;
  ++request_;
  look_again_.cancel();
  connection_->stop_awaiting();  // that the client leaves
}

/// Waits for the end of the stream while something is done: nobody waits for it any more then. Behind bytes that are
/// not read yet, a next request, only the state of the connection tells, and nothing wakes.
asio::awaitable<void> HttpRoutes::give_up_when_client_leaves(uint64_t request) {
  error_code code = co_await connection_->await_word();
  while (request_ == request && !code && !connection_->has_left()) {
    look_again_.expires_after(kLookAgain);
    co_await look_again_.async_wait(redirect_error_to(code));
  }
  if (request_ == request && !code) cancel();
}

}  // namespace surfcast::net
