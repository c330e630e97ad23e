#pragma once

#include <boost/asio/awaitable.hpp>
#include <utility>

#include "net/await_answer.h"
#include "net/session.h"

namespace surfcast::net {

/// Runs `work` where it may wait for the disk. It is passed as a variable: GCC 12 ends temporaries twice that have a
/// destructor and stand beside co_await.
template <typename Value, typename Work>
boost::asio::awaitable<Value> on_disk(NetContext& context, const Work& work) {
  return answer_of<Value>(
      [&context, work](auto done) { context.disk->post([work, done = std::move(done)] { done(work()); }); });
}

}  // namespace surfcast::net
