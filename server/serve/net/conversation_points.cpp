// The points of regions, which come in several messages.
#include <boost/asio/post.hpp>
#include <utility>

#include "net/conversation.h"
#include "net/convert.h"
#include "net/share_across_threads.h"

namespace surfcast::net {

namespace asio = boost::asio;

namespace {

/// Bytes of answers that the client has not taken, beyond which no further piece is made for it: about two of them, so
/// that one is made while another is on the line. Not a setting: what is kept for slow clients is.
constexpr size_t kUnreadPieces = size_t{2} << 20;

}  // namespace

void Conversation::handle_points(const wire::Request& request) {
  const uint64_t id = request.id();
  if (const Status admitted = window_.admit(id); !admitted) return send_error(id, admitted.error());
  Result<service::PointsJob> job = to_job(request.get_points(), rights().authorize(request.get_points().model()));
  if (!job) return send_error(id, job.error());
  audit_once("points", job->model);
  window_.add_other(id);
  Region region;
  region.only_count = job->query.only_count;
  const auto cancelled = region.cancelled;
  regions_.emplace(id, std::move(region));
  const auto counted = [self = share_across_threads(shared_from_this(), executor_), id,
                        cancelled](Result<std::shared_ptr<service::PointStream>> stream) {
    asio::post(self->executor_, [self, id, cancelled, stream = std::move(stream)]() mutable {
      if (!*cancelled) self->begin_points(id, std::move(stream));
    });
  };
  context_->service.points(std::move(*job), cancelled, counted, client_.id);
}

void Conversation::begin_points(uint64_t id, Result<std::shared_ptr<service::PointStream>> stream) {
  if (!stream) {
    ++context_->metrics.errors;
    return finish_points(id, encode_error(id, stream.error()));
  }
  Region& region = regions_.at(id);
  const Bytes total = encode_total(id, (*stream)->facts().count, !region.only_count);
  if (region.only_count) return finish_points(id, total);
  region.stream = std::move(*stream);
  send(total);
  advance_points();
}

/// Asks for the next piece of each region, while the client takes what it is sent.
void Conversation::advance_points() {
  for (auto& [id, region] : regions_) {
    if (!writer_ || writer_->unread_bytes() > kUnreadPieces) return;
    if (!region.stream || region.asked) continue;
    region.asked = true;
    const auto made = [self = share_across_threads(shared_from_this(), executor_), id = id,
                       cancelled = region.cancelled](const Result<service::PointPiece>& piece) {
      PointsMessage message = piece ? PointsMessage{encode_piece(id, *piece), piece->last, false}
                                    : PointsMessage{encode_error(id, piece.error()), true, true};
      asio::post(self->executor_, [self, id, cancelled, message = std::move(message)]() mutable {
        if (!*cancelled) self->send_points(id, std::move(message));
      });
    };
    context_->service.next_piece(region.stream, made, client_.id);
  }
}

void Conversation::send_points(uint64_t id, PointsMessage message) {
  if (message.failed) ++context_->metrics.errors;
  if (message.last) return finish_points(id, std::move(message.answer));
  regions_.at(id).asked = false;
  send(std::move(message.answer));
  advance_points();
}

void Conversation::finish_points(uint64_t id, Bytes answer) {
  regions_.erase(id);
  window_.finish(id);
  send(std::move(answer));
  draw_next();
  if (writer_) writer_->answer_sent();
}

/// False if that is no region whose points are on their way.
bool Conversation::cancel_points(uint64_t id) {
  const auto region = regions_.find(id);
  if (region == regions_.end()) return false;
  *region->second.cancelled = true;
  regions_.erase(region);
  window_.finish(id);
  return true;
}

}  // namespace surfcast::net
