#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "access/authorization.h"
#include "net/http_answer.h"
#include "net/http_connection.h"
#include "net/http_route.h"
#include "net/session.h"

namespace surfcast::net {

/// Answers what is asked at the routes of HTTP: asks the service and puts its results into answers, one at a time.
class HttpRoutes : public std::enable_shared_from_this<HttpRoutes> {
 public:
  HttpRoutes(std::shared_ptr<NetContext> context, std::shared_ptr<HttpConnection> connection,
             const service::Client& client);

  /// The answer to a GET. `accept`: the header of the request. The references must outlive the coroutine.
  boost::asio::awaitable<HttpAnswer> answer(ServerRoute route, const std::string& accept);
  boost::asio::awaitable<HttpAnswer> answer(const ModelRoute& route, const access::AuthorizedModel& model);
  /// Who asks from here on, and what they may do.
  void set_user(access::Rights rights, const service::Client& client);
  /// Gives up what is being done for the client, if there is something; false: there is nothing.
  bool cancel();

 private:
  boost::asio::awaitable<HttpAnswer> answer_model(const access::AuthorizedModel& model);
  boost::asio::awaitable<HttpAnswer> answer_picture(const std::string& query, const access::AuthorizedModel& model);
  boost::asio::awaitable<HttpAnswer> answer_pick(const std::string& query, const access::AuthorizedModel& model);
  boost::asio::awaitable<HttpAnswer> answer_profile(const std::string& query, const access::AuthorizedModel& model);
  boost::asio::awaitable<HttpAnswer> answer_points(const std::string& query, const access::AuthorizedModel& model);
  boost::asio::awaitable<Result<std::shared_ptr<service::PointStream>>> count(service::PointsJob job);
  boost::asio::awaitable<Result<service::PointPiece>> next_piece(std::shared_ptr<service::PointStream> stream);
  boost::asio::awaitable<HttpAnswer> answer_models();
  [[nodiscard]] HttpAnswer answer_metrics(const std::string& accept) const;
  boost::asio::awaitable<Result<service::EncodedPicture>> draw(service::PictureJob job);
  void begin_request(std::function<bool()> give_up);
  void end_request();
  boost::asio::awaitable<void> give_up_when_client_leaves(uint64_t request);

  std::shared_ptr<NetContext> context_;
  std::shared_ptr<HttpConnection> connection_;
  service::Client client_;
  access::Rights rights_ = access::Rights::of(nullptr);
  std::function<bool()> give_up_;         ///< ends what is being done for this client; null: nothing is
  uint64_t request_ = 0;                  ///< number of what is being done
  boost::asio::steady_timer look_again_;  ///< whether the client is still there
};

}  // namespace surfcast::net
