#include "object_store/remote_source.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <list>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "base/contract.h"

namespace surfcast::object_store {
namespace {

/// What the first request asks for: the header of a model, and all of a small one.
constexpr uint64_t kFirstBytes = uint64_t{16} << 10;

/// A request for a range, from being queued until all of its parts that somebody wants have been read.
struct Fetch {
  ByteRange range;
  std::vector<ByteRange> wanted;  ///< parts that were announced and not read yet
  size_t readers = 0;             ///< threads that wait for it
  bool running = false;
  bool done = false;
  uint64_t held = 0;  ///< bytes of memory, from when it begins
  Status outcome{};
  std::vector<std::byte> bytes{};  ///< constant once it is done
};
using FetchPointer = std::shared_ptr<Fetch>;

}  // namespace

class RemoteSource::State : public std::enable_shared_from_this<RemoteSource::State> {
 public:
  State(const HttpClient& client, StorePlace place, std::string name, ObjectVersion version,
        std::vector<std::byte> head)
      : client_(client),
        place_(std::move(place)),
        name_(std::move(name)),
        version_(std::move(version)),
        head_(std::move(head)) {}

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] uint64_t size() const { return version_.size; }
  /// Of a URL all but its query, which may be a signature that changes.
  [[nodiscard]] std::string version() const {
    return place_.url.substr(0, place_.url.find('?')) + ' ' + version_.etag + ' ' + std::to_string(version_.size);
  }

  Status read(const ByteRange& range, std::span<std::byte> bytes) {
    if (range.end() > version_.size) return fail(ErrorKind::kInvalidInput, "the object ends before");
    if (range.end() <= head_.size()) {
      std::copy_n(head_.begin() + static_cast<ptrdiff_t>(range.offset), range.size, bytes.begin());
      return {};
    }
    std::unique_lock lock(mutex_);
    const FetchPointer fetch = fetch_now(range);
    ++fetch->readers;
    arrived_.wait(lock, [&] { return fetch->done; });
    --fetch->readers;
    std::erase(fetch->wanted, range);
    drop_unused();
    start_more();
    lock.unlock();
    if (!fetch->outcome) return fetch->outcome;
    std::copy_n(fetch->bytes.begin() + static_cast<ptrdiff_t>(range.offset - fetch->range.offset), range.size,
                bytes.begin());
    return {};
  }

  void prefetch(std::span<const ByteRange> ranges) {
    const std::lock_guard lock(mutex_);
    std::vector<ByteRange> fresh;
    for (const ByteRange& range : ranges) {
      if (range.size == 0 || range.end() <= head_.size() || range.end() > version_.size) continue;
      if (const FetchPointer fetch = find(range)) {
        fetch->wanted.push_back(range);
      } else {
        fresh.push_back(range);
      }
    }
    for (const JoinedRange& joined : join_ranges(fresh, client_.config().join)) {
      const FetchPointer fetch = add(joined.range);
      for (const uint32_t member : joined.members) fetch->wanted.push_back(fresh[member]);
      queue_.push_back(fetch);
    }
    start_more();
  }

  void forget(const ByteRange& range) {
    const std::lock_guard lock(mutex_);
    if (const FetchPointer fetch = find(range)) std::erase(fetch->wanted, range);
    drop_unused();
    start_more();
  }

  /// Asks for one byte of the version that was opened.
  void look_for_replacement() {
    const ByteRange first_byte{0, 1};
    HttpRequest request = request_for(first_byte);
    const Result<HttpAnswer> answer = client_.send_and_wait(
        std::move(request),
        [this, first_byte](const HttpAnswer& first) { return check_range_answer(first, first_byte, version_); });
    if (answer || answer.error().kind != ErrorKind::kReplaced) return;
    const std::lock_guard lock(mutex_);
    replaced_ = true;
  }

  [[nodiscard]] bool replaced() const {
    const std::lock_guard lock(mutex_);
    return replaced_;
  }

 private:
  [[nodiscard]] HttpRequest request_for(const ByteRange& range) const {
    HttpRequest request = client_.request(place_);
    request.headers.push_back("If-Match: " + version_.etag);
    request.range = range;
    request.most_bytes = range.size;
    return request;
  }

  // All of what follows is called with mutex_ locked, except `arrive`.

  [[nodiscard]] FetchPointer find(const ByteRange& range) const {
    const auto found =
        std::ranges::find_if(fetches_, [&](const FetchPointer& fetch) { return fetch->range.contains(range); });
    return found == fetches_.end() ? nullptr : *found;
  }

  FetchPointer add(const ByteRange& range) {
    fetches_.push_back(std::make_shared<Fetch>(Fetch{range, {}}));
    return fetches_.back();
  }

  /// The fetch of a range that somebody waits for. It is the next to be started, whatever memory others hold.
  FetchPointer fetch_now(const ByteRange& range) {
    FetchPointer fetch = find(range);
    if (!fetch) fetch = add(range);
    if (fetch->running || fetch->done) return fetch;
    std::erase(queue_, fetch);
    queue_.push_front(fetch);
    ++fetch->readers;  // start_more() takes those with readers first
    start_more();
    --fetch->readers;
    return fetch;
  }

  /// Starts what is queued, as long as there are requests and memory for it.
  void start_more() {
    const StoreConfig& config = client_.config();
    while (!queue_.empty() && running_ < config.requests) {
      const FetchPointer fetch = queue_.front();
      const bool fits = held_ == 0 || held_ + fetch->range.size <= config.buffer_bytes;
      if (!fits && fetch->readers == 0) return;
      queue_.pop_front();
      start(fetch);
    }
  }

  void start(const FetchPointer& fetch) {
    fetch->running = true;
    ++running_;
    held_ += fetch->held = fetch->range.size;
    client_.send(
        request_for(fetch->range),
        [range = fetch->range, version = version_](const HttpAnswer& answer) {
          return check_range_answer(answer, range, version);
        },
        [state = weak_from_this(), fetch](Result<HttpAnswer> answer) {
          if (const auto self = state.lock()) self->arrive(*fetch, std::move(answer));
        });
  }

  /// Called by the thread of the client.
  void arrive(Fetch& fetch, Result<HttpAnswer> answer) {
    {
      const std::lock_guard lock(mutex_);
      fetch.running = false;
      fetch.done = true;
      --running_;
      if (answer) {
        fetch.bytes = std::move(answer->body);
      } else {
        replaced_ |= answer.error().kind == ErrorKind::kReplaced;
        if (answer.error().kind == ErrorKind::kUnavailable) fail_queued(answer.error());
        give_up(fetch, std::move(answer.error()));
      }
      drop_unused();
      start_more();
    }
    arrived_.notify_all();
  }

  static void give_up(Fetch& fetch, Error error) {
    fetch.done = true;
    fetch.outcome = fail(std::move(error));
    fetch.wanted.clear();  // whoever reads one of these later asks again
  }

  void fail_queued(const Error& error) {
    for (const FetchPointer& fetch : std::exchange(queue_, {})) give_up(*fetch, error);
  }

  /// Drops what nobody will read: fetches that have not begun, and memory of those that are done.
  void drop_unused() {
    std::erase_if(fetches_, [this](const FetchPointer& fetch) {
      if (fetch->running || fetch->readers > 0 || !fetch->wanted.empty()) return false;
      if (fetch->done) {
        held_ -= fetch->held;
      } else {
        std::erase(queue_, fetch);
      }
      return true;
    });
  }

  const HttpClient& client_;
  const StorePlace place_;
  const std::string name_;
  const ObjectVersion version_;
  const std::vector<std::byte> head_;  ///< the first bytes of the object
  mutable std::mutex mutex_;           ///< guards what follows
  std::condition_variable arrived_;
  std::list<FetchPointer> fetches_;
  std::deque<FetchPointer> queue_;  ///< of fetches_, those that have not begun
  size_t running_ = 0;              ///< of fetches_
  uint64_t held_ = 0;               ///< bytes of those that have begun
  bool replaced_ = false;
};

RemoteSource::RemoteSource(std::shared_ptr<State> state) : state_(std::move(state)) {}
RemoteSource::~RemoteSource() = default;

Result<std::unique_ptr<RemoteSource>> RemoteSource::open(const HttpClient& client, const StorePlace& place,
                                                         const std::string& name) {
  HttpRequest request = client.request(place);
  request.range = ByteRange{0, kFirstBytes};
  request.most_bytes = kFirstBytes;
  ObjectVersion version;
  Result<HttpAnswer> answer = client.send_and_wait(std::move(request), [&version](const HttpAnswer& first) {
    return check_first_answer(first, kFirstBytes, version);
  });
  if (!answer) return fail_about(name, answer);
  auto state = std::make_shared<State>(client, place, name, std::move(version), std::move(answer->body));
  return std::unique_ptr<RemoteSource>(new RemoteSource(std::move(state)));
}

const std::string& RemoteSource::name() const {
  return state_->name();
}

uint64_t RemoteSource::size() const {
  return state_->size();
}

Status RemoteSource::read(uint64_t offset, std::span<std::byte> bytes) const {
  return bytes.empty() ? Status() : state_->read({offset, bytes.size()}, bytes);
}

void RemoteSource::prefetch(std::span<const ByteRange> ranges) const {
  state_->prefetch(ranges);
}

void RemoteSource::forget(const ByteRange& range) const {
  state_->forget(range);
}

std::string RemoteSource::version() const {
  return state_->version();
}

void RemoteSource::look_for_replacement() const {
  state_->look_for_replacement();
}

bool RemoteSource::replaced() const {
  return state_->replaced();
}

}  // namespace surfcast::object_store
