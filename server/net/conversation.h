#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "base/result.h"
#include "net/answers.h"
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
  virtual void send(Bytes answer) = 0;
  /// Bytes of answers that the client has not taken.
  [[nodiscard]] virtual size_t unread_bytes() const = 0;
  /// An answer that was outstanding has been sent: the connection may end now if it waits for that.
  virtual void answer_sent() = 0;
};

/// What a client and the server say to each other after their hellos, whatever carries it: takes encoded requests,
/// hands out encoded answers. Answers of the service are made into bytes on the service's threads and posted here; all
/// else happens on the thread of the sockets.
class Conversation : public std::enable_shared_from_this<Conversation> {
 public:
  /// `writer` is kept until abandon() and while an answer is outstanding. `client`: see client_name.
  Conversation(std::shared_ptr<NetContext> context, service::SessionId session, boost::asio::any_io_executor executor,
               std::shared_ptr<AnswerWriter> writer, std::string client);

  /// Handles one encoded Request. Fails when it is none: the stream is of no use any more then.
  Status receive(std::span<const std::byte> message);
  /// The client has taken answers: what waited for that goes on.
  void resume_sending();
  /// Models may have newer editions, which views are to show.
  void models_changed();
  /// Cancels what is outstanding; nothing is sent from here on.
  void abandon();

  [[nodiscard]] size_t outstanding() const { return window_.outstanding(); }

 private:
  void handle(const wire::Request& request);
  void handle_picture(const wire::Request& request);
  void handle_other(const wire::Request& request);
  void handle_pick(const wire::Request& request);
  void handle_profile(const wire::Request& request);
  void handle_cancel(const wire::Request& request);
  void handle_open_view(const wire::Request& request);
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
  void send(Bytes answer);
  void send_error(uint64_t id, const Error& error);

  std::shared_ptr<NetContext> context_;
  service::SessionId session_;
  std::string client_;
  boost::asio::any_io_executor executor_;
  std::shared_ptr<AnswerWriter> writer_;  ///< null once abandoned
  RequestWindow window_;
  struct OpenedView {
    std::shared_ptr<view::ViewSession> view;
    std::string picture;  ///< encoded, what was asked for last
    std::string model;
    Counted counted;
  };
  std::map<uint64_t, OpenedView> views_;  ///< by the id of their OpenView
  boost::asio::steady_timer view_timer_;  ///< when a view is to be looked at again
};

}  // namespace surfcast::net
