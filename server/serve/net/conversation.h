#pragma once

#include <atomic>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "access/authorization.h"
#include "base/result.h"
#include "net/answers.h"
#include "net/kept_sessions.h"
#include "net/request_window.h"
#include "net/session.h"
#include "surfcast.pb.h"
#include "view/view_session.h"

namespace surfcast::net {

/// The connection beneath a conversation: where its answers go. Used on the thread of the sockets.
class AnswerWriter {
 public:
  virtual ~AnswerWriter() = default;

  /// Queues one encoded Answer; nothing once the connection is closed.
  /// `memory` is kept until the client has taken the answer, or is gone.
  virtual void send(Bytes answer, std::shared_ptr<const void> memory) = 0;
  /// Bytes of answers that the client has not taken.
  [[nodiscard]] virtual size_t unread_bytes() const = 0;
  /// An answer that was outstanding has been sent: the connection may end now if it waits for that.
  virtual void answer_sent() = 0;
  /// Queues the last answer; the connection ends once it is sent.
  virtual void end(Bytes answer) = 0;
};

/// What a client and the server say to each other after their hellos, whatever carries it: takes encoded requests,
/// hands out encoded answers. Answers of the service are made into bytes on the service's threads and posted here; all
/// else happens on the thread of the sockets.
class Conversation : public KeptSessions::Holder, public std::enable_shared_from_this<Conversation> {
 public:
  /// `writer` is kept until abandon() and while an answer is outstanding. `name`: of the client, see client_name.
  Conversation(std::shared_ptr<NetContext> context, const service::Client& client,
               boost::asio::any_io_executor executor, std::shared_ptr<AnswerWriter> writer, std::string name,
               const Gatekeeper::User& user);

  /// Handles one encoded Request. Fails when it is none: the stream is of no use any more then.
  Status receive(std::span<const std::byte> message);
  /// The client has taken answers: what waited for that goes on.
  void resume_sending();
  /// Models may have newer editions, which views are to show.
  void models_changed();
  /// Ends the conversation, with the reason, if the user has to leave.
  void check_user();
  /// Whether the client may ask for models.
  [[nodiscard]] bool admitted() const { return context_->gate->admits(user_); }
  /// Takes no more requests: the server stops.
  void refuse_requests() { refusing_ = true; }
  /// Cancels what is outstanding; nothing is sent from here on. Views wait for the client, if it has begun a session.
  void abandon();
  std::vector<KeptView> hand_over() override;

  [[nodiscard]] size_t outstanding() const { return window_.outstanding(); }
  [[nodiscard]] bool has_views() const { return !views_.empty(); }

 private:
  /// A message of the points of a region.
  struct PointsMessage {
    Bytes answer;
    bool last = false;
    bool failed = false;
  };
  /// A region whose points are on their way.
  struct Region {
    std::shared_ptr<std::atomic<bool>> cancelled = std::make_shared<std::atomic<bool>>(false);
    std::shared_ptr<service::PointStream> stream{};  ///< null until they are counted
    bool asked = false;                              ///< for the next piece
    bool only_count = false;
  };

  void handle(const wire::Request& request);
  void handle_admitted(const wire::Request& request);
  void handle_ping(const wire::Request& request);
  void handle_authenticate(const wire::Request& request);
  void welcome(const Gatekeeper::User& user);
  void deny(uint64_t id, const std::string& reason);
  [[nodiscard]] std::string refusal_of_view() const;
  void handle_picture(const wire::Request& request);
  void handle_other(const wire::Request& request);
  void handle_pick(const wire::Request& request);
  void handle_profile(const wire::Request& request);
  void handle_points(const wire::Request& request);
  void begin_points(uint64_t id, Result<std::shared_ptr<service::PointStream>> stream);
  void advance_points();
  void send_points(uint64_t id, PointsMessage message);
  void finish_points(uint64_t id, Bytes answer);
  [[nodiscard]] bool cancel_points(uint64_t id);
  void handle_cancel(const wire::Request& request);
  void handle_resume(const wire::Request& request);
  void handle_open_view(const wire::Request& request);
  Status open_view(KeptView wanted);
  [[nodiscard]] Status check_room_for_view(uint64_t id) const;
  [[nodiscard]] std::vector<KeptView> views_to_keep() const;
  [[nodiscard]] std::string owner() const { return user_ ? user_->name : ""; }
  void handle_update_view(const wire::Request& request);
  void handle_painted(const wire::Request& request);
  void handle_close_view(const wire::Request& request);
  void draw_next();
  view::ViewPort port_of(uint64_t view);
  void send_frame(uint64_t view, view::ViewMessage message);
  void end_view(uint64_t view, const Error& error);
  void advance_views();
  std::function<void(Outcome)> answer_later(uint64_t id);
  void hand_over(uint64_t id, Outcome outcome);
  void send(Bytes answer, std::shared_ptr<const void> memory = {});
  void send_error(uint64_t id, const Error& error);
  void audit_token(std::string_view outcome, const std::string& reason) const;
  [[nodiscard]] access::Rights rights() const { return context_->gate->rights(user_); }
  void audit(std::string_view what, const access::AuthorizedModel& model);
  void audit_once(std::string_view what, const access::AuthorizedModel& model);

  std::shared_ptr<NetContext> context_;
  service::Client client_;
  std::string client_name_;
  boost::asio::any_io_executor executor_;
  std::shared_ptr<AnswerWriter> writer_;  ///< null once abandoned
  RequestWindow window_;
  size_t unknown_ = 0;  ///< requests of unknown kinds, one after another
  struct OpenedView {
    std::shared_ptr<view::ViewSession> view;
    KeptView wanted;  ///< its quality is that at the beginning
    access::AuthorizedModel model;
    Counted counted;
    std::optional<Counted> counted_user;
  };
  std::map<uint64_t, OpenedView> views_;  ///< by the id of their OpenView
  std::map<uint64_t, Region> regions_;    ///< by the id of their GetPoints
  Gatekeeper::User user_;                 ///< null: nobody that is known
  std::optional<Counted> counted_user_;
  std::string session_;  ///< its secret; empty: there is none
  bool refusing_ = false;
  std::set<std::string> audited_;         ///< what was asked of which model
  boost::asio::steady_timer view_timer_;  ///< when a view is to be looked at again
};

}  // namespace surfcast::net
