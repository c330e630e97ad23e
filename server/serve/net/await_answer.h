#pragma once

#include <boost/asio/associated_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <memory>
#include <utility>

#include "net/share_across_threads.h"

namespace surfcast::net {

/// Waits in a coroutine for something that calls back from another thread. `start` gets the callback.
template <typename Value, typename Start>
boost::asio::awaitable<Value> answer_of(Start start) {
  namespace asio = boost::asio;
  const auto initiate = [&start](auto handler) {
    const auto executor = asio::get_associated_executor(handler);
    const auto shared = share_across_threads(std::make_shared<decltype(handler)>(std::move(handler)), executor);
    start([shared, executor](Value value) {
      asio::post(executor,
                 [shared, value = std::make_shared<Value>(std::move(value))] { (*shared)(std::move(*value)); });
    });
  };
  co_return co_await asio::async_initiate<const asio::use_awaitable_t<>, void(Value)>(initiate, asio::use_awaitable);
}

}  // namespace surfcast::net
