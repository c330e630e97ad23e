#pragma once

#include <array>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "base/result.h"

namespace surfcast::net {

/// Tells when files may have changed. Their folders are watched, not the files: a file is replaced by renaming another
/// one, and Kubernetes swaps a link beside it.
class FileWatch : public std::enable_shared_from_this<FileWatch> {
 public:
  /// `changed` is called on the executor, once for changes that follow each other closely.
  static Result<std::shared_ptr<FileWatch>> start(const boost::asio::any_io_executor& executor,
                                                  std::span<const std::filesystem::path> files,
                                                  std::function<void()> changed);
  void stop();

  FileWatch(const boost::asio::any_io_executor& executor, int descriptor, std::function<void()> changed);

 private:
  boost::asio::awaitable<void> watch();

  boost::asio::posix::stream_descriptor events_;
  boost::asio::steady_timer pause_;
  std::function<void()> changed_;
  std::array<std::byte, 4096> buffer_{};
};

}  // namespace surfcast::net
