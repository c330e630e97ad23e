#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <string_view>

#include "access/authorization.h"
#include "net/http_answer.h"
#include "net/session.h"
#include "net/upgrade.h"

namespace surfcast::net {

class HttpConnection;

using HeadParser = boost::beast::http::request_parser<boost::beast::http::empty_body>;

/// The scheme by which the client has reached this server, `tls` telling whether by TLS, or a proxy before it, which
/// says so in a header; empty: not known. The result points into the request.
std::string_view scheme_of(const HeadParser::value_type& request, bool tls);
/// Where a request comes from. The result points into it.
RequestOrigin origin_of(const HeadParser::value_type& request, bool tls);

/// The answer to a client that sends a scan. `whole`: nothing of the request is unread.
struct UploadOutcome {
  HttpAnswer answer;
  bool whole = false;
};

/// Receives the scan of a request whose head was read, and serves it. The references must outlive the coroutine.
boost::asio::awaitable<UploadOutcome> receive_scan(NetContext& context, HttpConnection& connection, HeadParser& head,
                                                   const access::AuthorizedUpload& upload);

}  // namespace surfcast::net
