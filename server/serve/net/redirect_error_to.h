#pragma once

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>

namespace surfcast::net {

/// Makes an operation awaitable that leaves its outcome in `code` instead of throwing.
inline auto redirect_error_to(boost::system::error_code& code) {
  return boost::asio::redirect_error(boost::asio::use_awaitable, code);
}

}  // namespace surfcast::net
