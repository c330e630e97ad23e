#include "net/share_across_threads.h"

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

namespace surfcast::net {
namespace {

struct Ending {
  std::thread::id thread;
  bool context_stopped = true;
};

/// Takes its time to end, as one with many timers might, and then says where and when it did.
struct Lodger {
  boost::asio::io_context& io;
  Ending& ending;
  Lodger(boost::asio::io_context& context, Ending& record) : io(context), ending(record) {}
  Lodger(const Lodger&) = delete;
  Lodger& operator=(const Lodger&) = delete;
  ~Lodger() {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ending = {std::this_thread::get_id(), io.stopped()};
  }
};

TEST(ShareAcrossThreadsTest, TheObjectEndsOnItsOwnThreadBeforeTheContextDoes) {
  Ending ending;
  boost::asio::io_context io{1};
  auto lent = share_across_threads(std::make_shared<Lodger>(io, ending), io.get_executor());
  std::jthread thread([&io] { io.run(); });
  const std::thread::id home = thread.get_id();
  lent.reset();
  thread.join();
  EXPECT_EQ(ending.thread, home);
  EXPECT_FALSE(ending.context_stopped);
  EXPECT_TRUE(io.stopped());
}

TEST(ShareAcrossThreadsTest, TheContextRunsOnWhileAShareIsOut) {
  Ending ending;
  boost::asio::io_context io{1};
  const auto object = std::make_shared<Lodger>(io, ending);
  auto lent = share_across_threads(object, io.get_executor());
  EXPECT_EQ(lent.get(), object.get());
  EXPECT_EQ(io.poll(), 0u);
  EXPECT_FALSE(io.stopped());
  const auto second = lent;
  lent.reset();
  io.poll();
  EXPECT_FALSE(io.stopped());
}

}  // namespace
}  // namespace surfcast::net
