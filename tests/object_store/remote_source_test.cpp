#include "object_store/remote_source.h"

#include <cstdlib>
#include <future>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "object_store/range_server.h"

namespace surfcast::object_store {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using testing::Fault;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::RangeServer;

constexpr const char* kPath = "/models/a.surf";

/// Bytes that differ wherever they are.
std::string content(size_t size, unsigned seed = 1) {
  std::string bytes(size, '\0');
  uint32_t state = seed;
  for (char& byte : bytes) {
    state = state * 1664525 + 1013904223;
    byte = static_cast<char>(state >> 24);
  }
  return bytes;
}

class RemoteSourceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ::setenv("no_proxy", "127.0.0.1", 1);
    server_.put(kPath, bytes_);
  }

  /// Opens the object, and forgets the request that this took.
  void open() {
    Result<std::unique_ptr<RemoteSource>> opened = try_open();
    ASSERT_TRUE(opened) << opened.error().message;
    source_ = std::move(*opened);
    server_.forget_requests();
  }
  /// The same for requests that fail so: of those that are not answered whole, nobody waits for the end.
  void open_for(Fault fault) {
    const bool silent = fault == Fault::kHanging || fault == Fault::kStalling;
    config_.stall_timeout = silent ? milliseconds(1000) : config_.timeout;
    open();
  }
  Result<std::unique_ptr<RemoteSource>> try_open() {
    Result<std::unique_ptr<HttpClient>> client = HttpClient::start(config_);
    if (!client) return fail(client);
    source_.reset();
    client_ = std::move(*client);
    return RemoteSource::open(*client_, StorePlace{server_.url(kPath), {}, false}, "the model");
  }
  [[nodiscard]] Result<std::string> read(const ByteRange& range) const {
    std::string bytes(range.size, '\0');
    const Status status = source_->read(range.offset, std::as_writable_bytes(std::span(bytes)));
    if (!status) return fail(status);
    return bytes;
  }
  [[nodiscard]] std::string expected(const ByteRange& range) const { return bytes_.substr(range.offset, range.size); }
  [[nodiscard]] std::vector<std::string> asked_ranges() const {
    std::vector<std::string> ranges;
    for (const RangeServer::Request& request : server_.requests()) ranges.push_back(request.headers.at("range"));
    return ranges;
  }

  const std::string bytes_ = content(size_t{2} << 20);
  RangeServer server_;
  // For answers that come, however busy the machine.
  StoreConfig config_{.timeout = milliseconds(60'000),
                      .connect_timeout = milliseconds(20'000),
                      .stall_timeout = milliseconds(20'000),
                      .retries = 2};
  std::unique_ptr<HttpClient> client_;
  std::unique_ptr<RemoteSource> source_;
};

constexpr ByteRange kPart{1'000'000, 5000};

TEST_F(RemoteSourceTest, ItsBytesAreThoseOfTheObject) {
  open();
  EXPECT_EQ(source_->size(), bytes_.size());
  EXPECT_EQ(source_->name(), "the model");
  for (const ByteRange range : {kPart, ByteRange{0, 64}, ByteRange{10'000, 20'000}, ByteRange{bytes_.size() - 1, 1}}) {
    const Result<std::string> read_bytes = read(range);
    ASSERT_TRUE(read_bytes) << read_bytes.error().message;
    EXPECT_TRUE(*read_bytes == expected(range));
  }
  EXPECT_EQ(server_.requests().size(), 3U) << "the first bytes came when the object was opened";
  EXPECT_EQ(server_.requests()[0].headers.at("if-match"), "\"version-1\"");
  EXPECT_FALSE(read({bytes_.size() - 1, 2}));
}

TEST_F(RemoteSourceTest, OpeningIsOneRequestAndHoldsAllOfASmallObject) {
  server_.put(kPath, content(100));
  const auto opened = try_open();
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_EQ((*opened)->size(), 100U);
  std::string all(100, '\0');
  EXPECT_TRUE((*opened)->read(0, std::as_writable_bytes(std::span(all))));
  EXPECT_TRUE(all == content(100));
  EXPECT_EQ(server_.requests().size(), 1U);
}

TEST_F(RemoteSourceTest, NeighbouringRangesAreOneRequestAndEachGetsItsOwnBytes) {
  open();
  std::vector<ByteRange> ranges;
  for (uint64_t i = 0; i < 20; ++i) ranges.push_back({100'000 + 10'100 * i, 10'000});
  source_->prefetch(ranges);
  for (size_t i = ranges.size(); i-- > 0;) EXPECT_TRUE(read(ranges[i]) == expected(ranges[i])) << i;
  EXPECT_THAT(asked_ranges(), ElementsAre("bytes=100000-301899"));
  EXPECT_EQ(server_.bytes(), 201'900U);
}

TEST_F(RemoteSourceTest, WhatWasReadIsNotKept) {
  open();
  source_->prefetch(std::vector<ByteRange>{kPart});
  EXPECT_TRUE(read(kPart));
  EXPECT_TRUE(read(kPart));
  EXPECT_EQ(server_.requests().size(), 2U);
}

TEST_F(RemoteSourceTest, SeveralRequestsAreOnTheirWayAtATimeAndNoMoreThanTheLimit) {
  config_.requests = 4;
  config_.join.gap = 0;
  config_.stall_timeout = config_.timeout;
  open();
  std::vector<ByteRange> ranges;
  for (uint64_t i = 0; i < 12; ++i) ranges.push_back({100'000 + 20'000 * i, 10'000});
  server_.hold();
  source_->prefetch(ranges);
  server_.wait_for_held(4);
  server_.release();
  for (const ByteRange& range : ranges) EXPECT_TRUE(read(range) == expected(range));
  EXPECT_EQ(server_.requests().size(), 12U);
  EXPECT_EQ(server_.most_at_once(), 4U);
}

TEST_F(RemoteSourceTest, WhatIsForgottenBeforeItsRequestIsNotAskedFor) {
  config_.requests = 1;
  config_.join.gap = 0;
  config_.stall_timeout = config_.timeout;
  open();
  const std::vector<ByteRange> ranges{{100'000, 10'000}, {200'000, 10'000}, {300'000, 10'000}};
  server_.hold();
  source_->prefetch(ranges);
  source_->forget(ranges[1]);
  server_.release();
  EXPECT_TRUE(read(ranges[2]) == expected(ranges[2]));
  EXPECT_TRUE(read(ranges[0]) == expected(ranges[0]));
  EXPECT_THAT(asked_ranges(), ElementsAre("bytes=100000-109999", "bytes=300000-309999"));
}

TEST_F(RemoteSourceTest, MoreThanTheBufferHoldsIsReadToo) {
  config_.buffer_bytes = 1;
  config_.join.gap = 0;
  open();
  std::vector<ByteRange> ranges;
  for (uint64_t i = 0; i < 10; ++i) ranges.push_back({100'000 + 20'000 * i, 10'000});
  source_->prefetch(ranges);
  for (size_t i = ranges.size(); i-- > 0;) EXPECT_TRUE(read(ranges[i]) == expected(ranges[i]));
  EXPECT_EQ(server_.requests().size(), 10U);
  EXPECT_LE(server_.most_at_once(), 2U) << "one that fits, and one that is waited for";
}

TEST_F(RemoteSourceTest, ManyThreadsReadAtOnce) {
  open();
  std::vector<ByteRange> ranges;
  for (uint64_t i = 0; i < 64; ++i) ranges.push_back({20'000 + 30'000 * i, 20'000});
  source_->prefetch(ranges);
  std::vector<std::future<bool>> readers;
  for (size_t first = 0; first < 8; ++first) {
    readers.push_back(std::async(std::launch::async, [&, first] {
      for (size_t i = first; i < ranges.size(); i += 8) {
        if (read(ranges[i]) != expected(ranges[i])) return false;
      }
      return true;
    }));
  }
  for (std::future<bool>& reader : readers) EXPECT_TRUE(reader.get());
}

TEST_F(RemoteSourceTest, ASourceMayEndWhileItsRequestsAreOnTheirWay) {
  open();
  server_.fail(Fault::kHanging, 1);
  source_->prefetch(std::vector<ByteRange>{kPart});
  source_.reset();
  client_.reset();
}

TEST_F(RemoteSourceTest, WhatPassesIsAskedAgainAndThenRight) {
  for (const Fault fault : {Fault::kBusy, Fault::kCut, Fault::kHanging, Fault::kStalling, Fault::kTooLong}) {
    open_for(fault);
    server_.fail(fault, 2);
    const Result<std::string> bytes = read(kPart);
    ASSERT_TRUE(bytes) << static_cast<int>(fault) << bytes.error().message;
    EXPECT_TRUE(*bytes == expected(kPart));
    EXPECT_EQ(server_.requests().size(), 3U);
  }
}

TEST_F(RemoteSourceTest, WhatDoesNotPassEndsInTime) {
  for (const Fault fault : {Fault::kBusy, Fault::kCut, Fault::kHanging, Fault::kStalling, Fault::kTooLong}) {
    open_for(fault);
    server_.fail(fault, 100);
    const auto begin = std::chrono::steady_clock::now();
    const Result<std::string> bytes = read(kPart);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, milliseconds(50'000))
        << "whoever only heeds the total time takes a minute";
    ASSERT_FALSE(bytes);
    EXPECT_EQ(bytes.error().kind, ErrorKind::kUnavailable);
    EXPECT_EQ(server_.requests().size(), 3U) << "the first, and two more";
    server_.fail(Fault::kNone, 0);
    EXPECT_TRUE(read(kPart) == expected(kPart)) << "an error is not kept";
  }
}

TEST_F(RemoteSourceTest, ATotalTimeBoundsAllAttempts) {
  config_.retries = 100;
  config_.timeout = milliseconds(2500);
  config_.stall_timeout = milliseconds(1000);
  open();
  server_.fail(Fault::kHanging, 1000);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(read(kPart));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, milliseconds(25'000)) << "all attempts take a hundred seconds";
}

TEST_F(RemoteSourceTest, ALinkThatGoesOnMayTakeLongerAndWaitingForATurnDoesNotCount) {
  config_.requests = 1;
  config_.timeout = milliseconds(2000);
  config_.least_rate = 1;
  open();
  const auto other = RemoteSource::open(*client_, StorePlace{server_.url(kPath), {}, false}, "the other");
  ASSERT_TRUE(other);
  server_.fail(Fault::kDripping, 2);
  auto waits = std::async(std::launch::async, [&] { return read(kPart).has_value(); });
  std::string bytes(kPart.size, '\0');
  EXPECT_TRUE((*other)->read(kPart.offset, std::as_writable_bytes(std::span(bytes))));
  EXPECT_TRUE(bytes == expected(kPart));
  EXPECT_TRUE(waits.get());
}

TEST_F(RemoteSourceTest, ALinkBelowTheLeastRateIsGivenUpInTime) {
  config_.timeout = milliseconds(1000);
  config_.retries = 0;
  for (const uint64_t rate : {uint64_t{0}, kPart.size}) {
    config_.least_rate = rate;
    open();
    server_.fail(Fault::kDripping, 1);
    const Result<std::string> bytes = read(kPart);
    ASSERT_FALSE(bytes) << rate;
    EXPECT_EQ(bytes.error().kind, ErrorKind::kUnavailable);
  }
}

TEST_F(RemoteSourceTest, WhatWaitsBehindARequestThatIsGivenUpFailsWithIt) {
  config_.requests = 1;
  config_.retries = 0;
  config_.join.gap = 0;
  config_.stall_timeout = milliseconds(1000);
  open();
  server_.fail(Fault::kHanging, 1);
  const std::vector<ByteRange> ranges{{100'000, 10'000}, {200'000, 10'000}, {300'000, 10'000}};
  source_->prefetch(ranges);
  std::vector<std::future<bool>> readers;
  for (const ByteRange& range : ranges) {
    readers.push_back(std::async(std::launch::async, [&] { return read(range).has_value(); }));
  }
  EXPECT_FALSE(readers[0].get());
  for (std::future<bool>& reader : readers) {
    if (reader.valid()) reader.wait();
  }
  EXPECT_TRUE(read(ranges[2]) == expected(ranges[2])) << "an error is not kept";
}

TEST_F(RemoteSourceTest, AReplacementIsFoundWithoutReading) {
  open();
  source_->look_for_replacement();
  EXPECT_FALSE(source_->replaced());
  server_.fail(Fault::kAbsent, 1);
  source_->look_for_replacement();
  EXPECT_FALSE(source_->replaced());
  server_.put(kPath, content(bytes_.size(), 2));
  source_->look_for_replacement();
  EXPECT_TRUE(source_->replaced());
}

TEST_F(RemoteSourceTest, WhereTheLogHasTheFaultsErrorsNameNoHosts) {
  const StorePlace nobody{"http://127.0.0.1:1/a.surf", {}, false};
  for (const std::optional<size_t> lines : {std::optional<size_t>(), std::optional<size_t>(10)}) {
    config_.log_lines = lines;
    const auto client = HttpClient::start(config_);
    const std::string silent = RemoteSource::open(**client, nobody, "a").error().message;
    EXPECT_EQ(silent.find("127.0.0.1") == std::string::npos, lines.has_value()) << silent;
    server_.fail(Fault::kRedirection, 1);
    const StorePlace place{server_.url(kPath), {}, false};
    const std::string redirected = RemoteSource::open(**client, place, "a").error().message;
    EXPECT_EQ(redirected.find("elsewhere") == std::string::npos, lines.has_value()) << redirected;
  }
}

TEST_F(RemoteSourceTest, WrongAnswersAreErrorsAtOnce) {
  const std::vector<std::pair<Fault, ErrorKind>> kinds{
      {Fault::kWholeObject, ErrorKind::kUnsupported},  {Fault::kForbidden, ErrorKind::kIo},
      {Fault::kAbsent, ErrorKind::kNotFound},          {Fault::kNoSuchRange, ErrorKind::kInvalidInput},
      {Fault::kRedirection, ErrorKind::kUnsupported},  {Fault::kWrongRange, ErrorKind::kInvalidInput},
      {Fault::kShiftedRange, ErrorKind::kInvalidInput}};
  for (const auto& [fault, kind] : kinds) {
    open();
    server_.fail(fault, 1);
    const Result<std::string> bytes = read(kPart);
    ASSERT_FALSE(bytes) << static_cast<int>(fault);
    EXPECT_EQ(bytes.error().kind, kind) << bytes.error().message;
    EXPECT_EQ(server_.requests().size(), 1U);
    EXPECT_FALSE(source_->replaced());
    EXPECT_TRUE(read(kPart) == expected(kPart));
  }
}

TEST_F(RemoteSourceTest, FaultsOfTheFirstAnswerAreNamed) {
  const std::vector<std::pair<Fault, ErrorKind>> kinds{
      {Fault::kWholeObject, ErrorKind::kUnsupported}, {Fault::kForbidden, ErrorKind::kIo},
      {Fault::kAbsent, ErrorKind::kNotFound},         {Fault::kRedirection, ErrorKind::kUnsupported},
      {Fault::kWrongRange, ErrorKind::kInvalidInput}, {Fault::kBusy, ErrorKind::kUnavailable}};
  for (const auto& [fault, kind] : kinds) {
    server_.fail(fault, 3);
    const auto opened = try_open();
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().kind, kind);
    EXPECT_THAT(opened.error().message, HasSubstr("the model: the store"));
    EXPECT_THAT(opened.error().message, Not(HasSubstr("\n")));
  }
}

TEST_F(RemoteSourceTest, NobodyListeningIsAnErrorInTime) {
  config_.endpoint = "http://127.0.0.1:1";
  const auto client = HttpClient::start(config_);
  const auto opened = RemoteSource::open(**client, StorePlace{"http://127.0.0.1:1/a.surf", {}, false}, "a");
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().kind, ErrorKind::kUnavailable);
}

TEST_F(RemoteSourceTest, AnObjectThatIsReplacedGivesNothingMore) {
  open();
  server_.put(kPath, content(bytes_.size(), 2));
  const Result<std::string> bytes = read(kPart);
  ASSERT_FALSE(bytes);
  EXPECT_EQ(bytes.error().kind, ErrorKind::kReplaced);
  EXPECT_THAT(bytes.error().message, HasSubstr("replaced"));
  EXPECT_TRUE(source_->replaced());
}

TEST_F(RemoteSourceTest, AStoreThatIgnoresIfMatchIsCaughtByItsEtag) {
  open();
  server_.fail(Fault::kOtherVersion, 1);
  const Result<std::string> bytes = read(kPart);
  ASSERT_FALSE(bytes);
  EXPECT_EQ(bytes.error().kind, ErrorKind::kReplaced);
}

TEST_F(RemoteSourceTest, WithoutAStrongEtagNothingIsOpened) {
  for (const char* prefix : {"", "W/"}) {
    server_.set_etag_prefix(prefix);
    const auto opened = try_open();
    ASSERT_FALSE(opened) << prefix;
    EXPECT_EQ(opened.error().kind, ErrorKind::kUnsupported);
  }
}

}  // namespace
}  // namespace surfcast::object_store
