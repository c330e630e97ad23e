#pragma once

#include <boost/asio/awaitable.hpp>
#include <string>

#include "net/gatekeeper.h"
#include "net/http_answer.h"
#include "net/http_upload.h"
#include "net/session.h"

namespace surfcast::net {

class HttpConnection;

/// Who asks, and about which model.
struct AnnotationRequest {
  std::string model;
  Gatekeeper::User user{};
  service::Asker asker;
};

/// Whether a user, null for anybody, may write the annotations of a model.
bool may_annotate(const Gatekeeper::User& user, const std::string& model);

/// The answer to GET: the document, and its edition as the ETag. The references must outlive the coroutine.
boost::asio::awaitable<HttpAnswer> answer_annotations(NetContext& context, AnnotationRequest request);

/// Receives the document of a PUT whose head was read, and writes it. With If-Match, only if the present edition is
/// that one: else 412. The references must outlive the coroutine.
boost::asio::awaitable<HttpAnswer> receive_annotations(NetContext& context, HttpConnection& connection,
                                                       HeadParser& head, AnnotationRequest request);

}  // namespace surfcast::net
