#pragma once

#include <boost/asio/awaitable.hpp>

#include "access/authorization.h"
#include "net/http_answer.h"
#include "net/http_upload.h"
#include "net/session.h"

namespace surfcast::net {

class HttpConnection;

/// The answer to GET: the document, and its edition as the ETag. `writable`: the client may write it. The references
/// must outlive the coroutine.
boost::asio::awaitable<HttpAnswer> answer_annotations(NetContext& context, const access::AuthorizedModel& model,
                                                      bool writable, service::ClientId client);

/// Receives the document of a PUT whose head was read, and writes it. With If-Match, only if the present edition is
/// that one: else 412. The references must outlive the coroutine.
boost::asio::awaitable<HttpAnswer> receive_annotations(NetContext& context, HttpConnection& connection,
                                                       HeadParser& head,
                                                       const access::AuthorizedAnnotations& annotations,
                                                       service::ClientId client);

}  // namespace surfcast::net
