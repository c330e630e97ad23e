#include "object_store/remote_folder.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "object_store/range_answer.h"

namespace surfcast::object_store {
namespace {

/// Objects that were announced and are requested, or wait to be read. Further ones are requested when there is room.
constexpr size_t kMaxAhead = 64;

/// A request for an object, from being queued until whoever announced it has read it.
struct ObjectFetch {
  size_t readers = 0;  ///< threads that wait for it
  bool announced = false;
  bool started = false;
  bool done = false;
  Result<std::vector<std::byte>> bytes{};
};
using ObjectFetchPointer = std::shared_ptr<ObjectFetch>;

/// The URL of an object in a folder. A query of the folder, which may hold a signature, is that of the object.
std::string join_url(const std::string& folder, const std::string& name) {
  const size_t query = folder.starts_with("s3://") ? std::string::npos : folder.find('?');
  return folder.substr(0, query) + name + (query == std::string::npos ? "" : folder.substr(query));
}

}  // namespace

class RemoteFolder::State : public std::enable_shared_from_this<RemoteFolder::State> {
 public:
  State(const HttpClient& client, std::string url) : client_(client), url_(std::move(url)) {}

  Result<std::vector<std::byte>> read(const std::string& name, uint64_t most) {
    std::unique_lock lock(mutex_);
    const ObjectFetchPointer fetch = find_or_add(name);
    ++fetch->readers;
    if (!fetch->started) start(name, fetch);
    arrived_.wait(lock, [&] { return fetch->done; });
    --fetch->readers;
    fetch->announced = false;
    drop(name, fetch);
    start_more();
    Result<std::vector<std::byte>> bytes = fetch->bytes;
    lock.unlock();
    if (!bytes) return fail_about(name, bytes);
    if (bytes->size() <= most) return bytes;
    return fail(ErrorKind::kLimit, name + ": has more than " + std::to_string(most) + " bytes");
  }

  void prefetch(std::span<const std::string> names) {
    const std::lock_guard lock(mutex_);
    for (const std::string& name : names) {
      const ObjectFetchPointer fetch = find_or_add(name);
      if (!fetch->announced && !fetch->started) queue_.push_back(name);
      fetch->announced = true;
    }
    start_more();
  }

  void forget(const std::string& name) {
    const std::lock_guard lock(mutex_);
    const auto found = fetches_.find(name);
    if (found == fetches_.end()) return;
    found->second->announced = false;
    drop(name, found->second);
    start_more();
  }

  bool replaced() {
    const std::lock_guard lock(mutex_);
    return replaced_;
  }

 private:
  // All of what follows is called with mutex_ locked, except `arrive`.

  ObjectFetchPointer find_or_add(const std::string& name) {
    ObjectFetchPointer& fetch = fetches_[name];
    if (!fetch) fetch = std::make_shared<ObjectFetch>();
    return fetch;
  }

  /// Drops a fetch that nobody will read. One that is running is dropped when it has arrived.
  void drop(const std::string& name, const ObjectFetchPointer& fetch) {
    if (fetch->announced || fetch->readers > 0 || (fetch->started && !fetch->done)) return;
    if (fetch->started) --ahead_;
    if (!fetch->started) std::erase(queue_, name);
    fetches_.erase(name);
  }

  void start_more() {
    while (!queue_.empty() && ahead_ < kMaxAhead) {
      const std::string name = std::move(queue_.front());
      queue_.pop_front();
      const auto found = fetches_.find(name);
      if (found != fetches_.end() && !found->second->started) start(name, found->second);
    }
  }

  void start(const std::string& name, const ObjectFetchPointer& fetch) {
    fetch->started = true;
    ++ahead_;
    const Result<StorePlace> place = place_of(join_url(url_, name), client_.config());
    if (!place) {
      fetch->done = true;
      fetch->bytes = fail(place);
      return;
    }
    HttpRequest request = client_.request(*place);
    request.most_bytes = client_.config().buffer_bytes;
    client_.send(std::move(request), check_whole_answer,
                 [state = weak_from_this(), name, fetch](Result<HttpAnswer> answer) {
                   if (const auto self = state.lock()) self->arrive(name, fetch, std::move(answer));
                 });
  }

  /// The bytes of an answer, unless they are newer than the folder was opened.
  Result<std::vector<std::byte>> take(Result<HttpAnswer> answer) {
    if (!answer) return fail(answer);
    if (!opened_) opened_ = answer->answered;
    if (!is_newer(*answer, opened_)) return std::move(answer->body);
    replaced_ = true;
    return fail(ErrorKind::kReplaced, "was replaced in the store since the folder was opened");
  }

  /// Called by the thread of the client.
  void arrive(const std::string& name, const ObjectFetchPointer& fetch, Result<HttpAnswer> answer) {
    {
      const std::lock_guard lock(mutex_);
      fetch->done = true;
      fetch->bytes = take(std::move(answer));
      drop(name, fetch);
      start_more();
    }
    arrived_.notify_all();
  }

  const HttpClient& client_;
  const std::string url_;
  std::mutex mutex_;  ///< guards what follows
  std::condition_variable arrived_;
  std::map<std::string, ObjectFetchPointer> fetches_;
  std::deque<std::string> queue_;  ///< announced, and not started
  size_t ahead_ = 0;               ///< started, and still in fetches_
  std::optional<int64_t> opened_;  ///< when the first answer came, seconds by the clock of the store
  bool replaced_ = false;
};

RemoteFolder::RemoteFolder(const HttpClient& client, std::string url)
    : state_(std::make_shared<State>(client, std::move(url))) {}
RemoteFolder::~RemoteFolder() = default;

Result<std::vector<std::byte>> RemoteFolder::read(const std::string& name, uint64_t most) const {
  return state_->read(name, most);
}

void RemoteFolder::prefetch(std::span<const std::string> names) const {
  state_->prefetch(names);
}

void RemoteFolder::forget(const std::string& name) const {
  state_->forget(name);
}

bool RemoteFolder::replaced() const {
  return state_->replaced();
}

}  // namespace surfcast::object_store
