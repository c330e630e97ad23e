#include "worker/channel.h"

#include <array>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

namespace surfcast::worker {
namespace {

using std::chrono::milliseconds;
constexpr milliseconds kLong{20'000};

struct Ends {
  Channel server;
  Channel worker;
};

Ends connected() {
  Result<std::pair<Channel, Channel>> ends = Channel::make_pair();
  EXPECT_TRUE(ends);
  return {std::move(ends->first), std::move(ends->second)};
}

TEST(ChannelTest, MessagesArriveInOrder) {
  Ends ends = connected();
  ASSERT_TRUE(ends.server.send(WithdrawModel{5}));
  ASSERT_TRUE(ends.server.send(Continue{true}));
  const auto first = ends.worker.receive(kLong);
  const auto second = ends.worker.receive(kLong);
  ASSERT_TRUE(first && first->has_value() && second && second->has_value());
  EXPECT_EQ(std::get<WithdrawModel>((*first)->message).model, 5U);
  EXPECT_TRUE(std::get<Continue>((*second)->message).preempted);
}

TEST(ChannelTest, DescriptorsTravelWithTheirMessage) {
  Ends ends = connected();
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  const Descriptor reading(pipe[0]);
  ASSERT_TRUE(ends.server.send(WithdrawModel{1}));
  {
    const Descriptor writing(pipe[1]);
    ASSERT_TRUE(ends.server.send(OfferModel{2, "a.surf", {}, {}}, writing.get()));
  }
  const auto without = ends.worker.receive(kLong);
  const auto with = ends.worker.receive(kLong);
  ASSERT_TRUE(without && without->has_value() && with && with->has_value());
  EXPECT_FALSE((*without)->descriptor);
  ASSERT_TRUE((*with)->descriptor);
  ASSERT_EQ(::write((*with)->descriptor.get(), "x", 1), 1);
  char read = 0;
  ASSERT_EQ(::read(reading.get(), &read, 1), 1);
  EXPECT_EQ(read, 'x');
}

TEST(ChannelTest, MessagesLargerThanTheBufferOfTheSocketArrive) {
  Ends ends = connected();
  OfferModel large{3, "large.surf", {}, {}};
  for (uint32_t i = 0; i < 3'000'000; ++i) large.quarantined.push_back(i);
  const std::jthread sender([&] { EXPECT_TRUE(ends.server.send(large)); });
  const auto received = ends.worker.receive(kLong);
  ASSERT_TRUE(received && received->has_value());
  EXPECT_EQ(std::get<OfferModel>((*received)->message).quarantined, large.quarantined);
}

TEST(ChannelTest, SilenceIsNoMessageAndAnEndIsAnError) {
  Ends ends = connected();
  const auto silence = ends.worker.receive(milliseconds(1));
  ASSERT_TRUE(silence);
  EXPECT_FALSE(silence->has_value());
  { const Channel gone = std::move(ends.server); }
  const auto end = ends.worker.receive(kLong);
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().kind, ErrorKind::kIo);
  EXPECT_FALSE(ends.worker.send(Continue{}));
}

TEST(ChannelTest, BytesThatAreNoMessageAreErrors) {
  for (const std::string& bytes :
       {std::string("\x04\0\0\0\xff\xff\xff\xff", 8), std::string("\xff\xff\xff\xff", 4), std::string("\0\0\0\0", 4)}) {
    Ends ends = connected();
    ASSERT_EQ(::send(ends.worker.socket().get(), bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
    const auto received = ends.server.receive(kLong);
    ASSERT_FALSE(received);
    EXPECT_EQ(received.error().kind, ErrorKind::kInvalidInput);
  }
}

TEST(ChannelTest, AnEndInTheMiddleOfAMessageIsAnError) {
  Ends ends = connected();
  ASSERT_EQ(::send(ends.worker.socket().get(), "\x64\0\0\0only", 8, 0), 8);
  { const Channel gone = std::move(ends.worker); }
  const auto received = ends.server.receive(kLong);
  ASSERT_FALSE(received);
  EXPECT_EQ(received.error().kind, ErrorKind::kIo);
}

}  // namespace
}  // namespace surfcast::worker
