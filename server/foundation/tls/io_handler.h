#pragma once

#include <array>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/associated_executor.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/system/error_code.hpp>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace surfcast::tls {

/// What an operation of a connection calls when it is done: any handler of Asio, with its executor. Operations are
/// instantiated for this type alone, once for all handlers. It has no cancellation slot: an operation ends early when
/// its socket is closed.
class IoHandler {
 public:
  using executor_type = boost::asio::any_io_executor;

  /// `Signature` is that of the operation: void(error_code), or void(error_code, size_t) if it counts bytes.
  template <typename Signature, typename Handler>
  static IoHandler erase(Handler handler, const executor_type& fallback) {
    executor_type executor = boost::asio::get_associated_executor(handler, fallback);
    return {std::move(executor), std::make_unique<Target<Handler, Signature>>(std::move(handler))};
  }

  [[nodiscard]] executor_type get_executor() const noexcept { return executor_; }

  /// At most once.
  void operator()(const boost::system::error_code& code, size_t bytes = 0) { target_->call(code, bytes); }

 private:
  struct AnyTarget {
    virtual ~AnyTarget() = default;
    virtual void call(const boost::system::error_code& code, size_t bytes) = 0;
  };

  template <typename Handler, typename Signature>
  struct Target : AnyTarget {
    explicit Target(Handler&& handler_in) : handler(std::move(handler_in)) {}

    void call(const boost::system::error_code& code, size_t bytes) override {
      if constexpr (std::is_same_v<Signature, void(boost::system::error_code, size_t)>) {
        std::move(handler)(code, bytes);
      } else {
        std::move(handler)(code);
      }
    }

    Handler handler;
  };

  IoHandler(executor_type executor, std::unique_ptr<AnyTarget> target)
      : executor_(std::move(executor)), target_(std::move(target)) {}

  executor_type executor_;
  std::unique_ptr<AnyTarget> target_;
};

/// The first buffers of any sequence of buffers that are not empty. Reads and writes of streams may take fewer bytes
/// than they are offered.
template <typename Buffer>
class BufferList {
 public:
  using value_type = Buffer;
  using const_iterator = const Buffer*;

  template <typename Buffers>
  explicit BufferList(const Buffers& buffers) {
    const auto last = boost::asio::buffer_sequence_end(buffers);
    for (auto next = boost::asio::buffer_sequence_begin(buffers); next != last && count_ < kMax; ++next) {
      const Buffer buffer(*next);
      if (buffer.size() > 0) list_[count_++] = buffer;
    }
  }

  [[nodiscard]] const_iterator begin() const { return list_.data(); }
  [[nodiscard]] const_iterator end() const { return list_.data() + count_; }

 private:
  static constexpr size_t kMax = 16;
  std::array<Buffer, kMax> list_{};
  size_t count_ = 0;
};

using ReadBuffers = BufferList<boost::asio::mutable_buffer>;
using WriteBuffers = BufferList<boost::asio::const_buffer>;

}  // namespace surfcast::tls
