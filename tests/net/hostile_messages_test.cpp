#include <boost/asio/io_context.hpp>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "net/conversation.h"
#include "net/sample_requests.h"
#include "service/fake_models.h"
#include "support/sample_size.h"

namespace surfcast::net {
namespace {

/// Takes answers as a connection would and looks whether they are answers.
class Listener : public AnswerWriter {
 public:
  void send(Bytes answer, std::shared_ptr<const void> /*memory*/) override {
    wire::Answer message;
    EXPECT_TRUE(message.ParseFromArray(answer.data(), static_cast<int>(answer.size())));
    EXPECT_NE(message.kind_case(), wire::Answer::KIND_NOT_SET);
    if (message.has_pong()) pongs.insert(message.id());
  }
  [[nodiscard]] size_t unread_bytes() const override { return 0; }
  void answer_sent() override {}
  void end(Bytes answer) override { send(std::move(answer), nullptr); }

  std::set<uint64_t> pongs;
};

/// A conversation without a connection, with a service whose pictures are small.
class HostileMessagesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    service::ServiceLimits limits;
    limits.pixels = 1024;
    auto service = service::RenderService::start(
        models_, service::fake_renderers(std::make_shared<service::FakeRendererControl>()), limits);
    ASSERT_TRUE(service);
    service_ = std::move(*service);
    context_ = std::make_shared<NetContext>(NetContext{*service_, ServerConfig{}, {}, false});
  }
  void TearDown() override {
    end_conversation();
    service_.reset();
    io_.restart();
    io_.run();
  }
  void begin_conversation() {
    listener_ = std::make_shared<Listener>();
    conversation_ = std::make_shared<Conversation>(context_, ++session_, io_.get_executor(), listener_, "nobody",
                                                   Gatekeeper::User());
  }
  void end_conversation() {
    if (!conversation_) return;
    conversation_->abandon();
    conversation_.reset();
    turn();
  }
  void turn() {
    io_.restart();
    io_.poll();
  }
  void say(const std::string& message) {
    static_cast<void>(conversation_->receive(std::as_bytes(std::span(message))));
    turn();
  }
  /// Whether the conversation goes on as if nothing had happened.
  bool still_answers() {
    constexpr uint64_t kId = 1'000'003;
    wire::Request ping;
    ping.set_id(kId);
    ping.mutable_ping();
    say(ping.SerializeAsString());
    return listener_->pongs.contains(kId);
  }

  service::FakeModels models_;
  std::unique_ptr<service::RenderService> service_;
  std::shared_ptr<NetContext> context_;
  boost::asio::io_context io_{1};
  std::shared_ptr<Listener> listener_;
  std::shared_ptr<Conversation> conversation_;
  service::SessionId session_ = 0;
};

/// Changes a message in one of the ways that find bugs: bits, bytes, numbers at their limits, pieces that are missing,
/// doubled, or another message's.
class Mutator {
 public:
  explicit Mutator(std::vector<std::string> seeds) : seeds_(std::move(seeds)) {}

  std::string next() {
    std::string message = any_seed();
    if (random_() % 2 == 0) {
      change(message, random_() % 2);  // in place, after which most messages can still be decoded
      return message;
    }
    for (uint32_t count = 1 + random_() % 4; count > 0; --count) change(message, random_() % 7);
    return message;
  }

 private:
  const std::string& any_seed() { return seeds_[random_() % seeds_.size()]; }
  size_t place_in(const std::string& message) { return random_() % (message.size() + 1); }

  void change(std::string& message, uint64_t way) {
    const size_t place = place_in(message);
    switch (way) {
      case 0:
        if (place < message.size()) message[place] = static_cast<char>(message[place] ^ 1 << random_() % 8);
        return;
      case 1:
        if (place < message.size()) message[place] = static_cast<char>(random_());
        return;
      case 2:
        message.insert(place, 1, static_cast<char>(random_()));
        return;
      case 3:
        message.erase(place, random_() % 8);
        return;
      case 4:
        message.insert(place, message.substr(place_in(message), random_() % 32));
        return;
      case 5: {
        const std::string& other = any_seed();
        message.replace(place, random_() % 16, other.substr(place_in(other), random_() % 32));
        return;
      }
      default:
        message.replace(place, random_() % 10, kLimits[random_() % kLimits.size()]);
    }
  }

  /// The largest varint, an overlong one, and as doubles: NaN, infinity, the largest, the smallest.
  inline static const std::vector<std::string> kLimits{
      std::string(9, '\xff') + '\x01',
      std::string(12, '\xff'),
      std::string("\0\0\0\0\0\0\xf8\x7f", 8),
      std::string("\0\0\0\0\0\0\xf0\xff", 8),
      std::string("\xff\xff\xff\xff\xff\xff\xef\x7f", 8),
      std::string("\x01\0\0\0\0\0\0\0", 8),
  };

  std::vector<std::string> seeds_;
  std::mt19937 random_{20'260'417};
};

std::vector<std::string> encoded_samples() {
  std::vector<std::string> messages;
  for (const wire::Request& request : sample_requests()) messages.push_back(request.SerializeAsString());
  return messages;
}

TEST(SampleRequests, AreOfEveryKind) {
  std::set<int> kinds;
  for (const wire::Request& request : sample_requests()) kinds.insert(request.kind_case());
  EXPECT_EQ(kinds.size(), 12u);
  EXPECT_FALSE(kinds.contains(wire::Request::KIND_NOT_SET));
}

TEST_F(HostileMessagesTest, EveryTruncationOfEveryKindIsSurvived) {
  for (const std::string& message : encoded_samples()) {
    for (size_t length = 0; length <= message.size(); ++length) {
      begin_conversation();
      say(message.substr(0, length));
      EXPECT_TRUE(still_answers()) << message.size() << " cut to " << length;
      end_conversation();
    }
  }
}

TEST_F(HostileMessagesTest, MutatedMessagesAreSurvived) {
  const int count = testing::sample_size("SURFCAST_MUTATIONS", 50'000);
  Mutator mutator(encoded_samples());
  for (int i = 0; i < count;) {
    begin_conversation();
    for (const int end = std::min(count, i + 40); i < end; ++i) say(mutator.next());
    ASSERT_TRUE(still_answers()) << "after " << i;
    end_conversation();
  }
  // Most are no messages at all any more; enough of them must get past the decoder, and past the checks behind it.
  const Metrics& metrics = context_->metrics;
  EXPECT_GT(metrics.requests, static_cast<uint64_t>(count) / 5);
  EXPECT_GT(metrics.errors, static_cast<uint64_t>(count) / 20);
  EXPECT_GT(metrics.requests - metrics.errors, static_cast<uint64_t>(count) / 20);
}

}  // namespace
}  // namespace surfcast::net
