#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <memory>
#include <utility>

namespace surfcast::net {

/// A share of an object that lives on the thread of `executor`, for use by other threads. While one is held the
/// io_context runs on, and the last one to go hands the object back: whoever drops it, the object ends on its own
/// thread, and before the context on which its timers and sockets stand.
template <typename T>
std::shared_ptr<T> share_across_threads(std::shared_ptr<T> object, const boost::asio::any_io_executor& executor) {
  T* const raw = object.get();
  return {raw, [object = std::move(object), work = boost::asio::make_work_guard(executor)](T*) mutable {
            boost::asio::post(work.get_executor(), [object = std::move(object)] {});
          }};
}

}  // namespace surfcast::net
