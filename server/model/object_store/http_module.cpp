#include "object_store/http_module.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include <curl/curl.h>

#include "base/ascii_text.h"

namespace surfcast::object_store {
namespace {

using Clock = HttpRequest::Clock;

constexpr long kWholeStatus = 200;
constexpr long kRangeStatus = 206;
/// Bodies of refusals are received up to this, so that the connection can be used again.
constexpr size_t kMaxRefusal = size_t{64} << 10;

/// A request on its way.
struct Transfer {
  HttpRequest request;
  HttpDone done;
  HttpAnswer answer{};
  std::unique_ptr<CURL, void (*)(CURL*)> easy{curl_easy_init(), curl_easy_cleanup};
  std::unique_ptr<curl_slist, void (*)(curl_slist*)> headers{nullptr, curl_slist_free_all};
  std::array<char, CURL_ERROR_SIZE> reason{};
  Clock::time_point progress{};  ///< of the last byte
  Clock::time_point deadline{};
  std::optional<int64_t> date{};  ///< of a cache between, if `age` is above 0
  int64_t age = 0;
  size_t refusal_bytes = 0;
  bool too_long = false;

  [[nodiscard]] long wanted_status() const { return request.range ? kRangeStatus : kWholeStatus; }
  [[nodiscard]] long status() const {
    long code = 0;
    curl_easy_getinfo(easy.get(), CURLINFO_RESPONSE_CODE, &code);
    return code;
  }
};

void forget_answer(Transfer& transfer) {
  const Clock::time_point sent = transfer.answer.sent;
  transfer.answer = {};
  transfer.answer.sent = sent;
  transfer.date.reset();
  transfer.age = 0;
}

/// A date of HTTP, seconds since 1970.
std::optional<int64_t> parse_date(const std::string& text) {
  const time_t time = curl_getdate(text.c_str(), nullptr);
  if (time < 0) return std::nullopt;
  return int64_t{time};
}

/// The header "Age", seconds; 0 if it is none.
int64_t parse_age(std::string_view text) {
  constexpr int64_t kMaxAge = int64_t{1} << 31;  // RFC 9111, 1.2.2
  int64_t age = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), age);
  return code == std::errc() ? std::clamp<int64_t>(age, 0, kMaxAge) : 0;
}

size_t take_header(char* data, size_t one, size_t count, void* user) {
  auto& transfer = *static_cast<Transfer*>(user);
  transfer.progress = Clock::now();
  const std::string_view line(data, one * count);
  if (line.starts_with("HTTP/")) forget_answer(transfer);  // one before this one: 100 Continue
  const size_t colon = line.find(':');
  if (colon == std::string_view::npos) return line.size();
  const std::string_view name = line.substr(0, colon);
  const std::string value(trimmed(line.substr(colon + 1)));
  if (equal_in_any_case(name, "etag")) transfer.answer.etag = value;
  if (equal_in_any_case(name, "content-range")) transfer.answer.content_range = value;
  if (equal_in_any_case(name, "location")) transfer.answer.location = value;
  if (equal_in_any_case(name, "last-modified")) transfer.answer.written = parse_date(value);
  if (equal_in_any_case(name, "date")) transfer.date = parse_date(value);
  if (equal_in_any_case(name, "age")) transfer.age = parse_age(value);
  if (transfer.date) transfer.answer.answered = *transfer.date + transfer.age;
  return line.size();
}

/// Returning another number than that of the bytes ends the transfer.
size_t take_body(char* data, size_t one, size_t count, void* user) {
  auto& transfer = *static_cast<Transfer*>(user);
  transfer.progress = Clock::now();
  const size_t bytes = one * count;
  const long status = transfer.status();
  if (status != transfer.wanted_status()) {
    transfer.refusal_bytes += bytes;
    return status == kWholeStatus || transfer.refusal_bytes > kMaxRefusal ? 0 : bytes;
  }
  std::vector<std::byte>& body = transfer.answer.body;
  transfer.too_long = body.size() + bytes > transfer.request.most_bytes;
  if (transfer.too_long) return 0;
  if (body.empty()) body.reserve(transfer.request.range ? transfer.request.range->size : bytes);
  const auto* first = reinterpret_cast<const std::byte*>(data);
  body.insert(body.end(), first, first + bytes);
  return bytes;
}

void set_options(Transfer& transfer, const HttpLimits& limits) {
  CURL* easy = transfer.easy.get();
  const HttpRequest& request = transfer.request;
  curl_easy_setopt(easy, CURLOPT_URL, request.url.c_str());
  curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(easy, CURLOPT_FOLLOWLOCATION, 0L);
  curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(easy, CURLOPT_HTTP_VERSION, CURL_HTTP_VERSION_2TLS);
  curl_easy_setopt(easy, CURLOPT_PIPEWAIT, 1L);  // one connection of HTTP/2 rather than many
  curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(limits.connect.count()));
  curl_easy_setopt(easy, CURLOPT_USERAGENT, "surfcastd");
  curl_easy_setopt(easy, CURLOPT_ERRORBUFFER, transfer.reason.data());
  curl_easy_setopt(easy, CURLOPT_PRIVATE, &transfer);
  curl_easy_setopt(easy, CURLOPT_HEADERFUNCTION, take_header);
  curl_easy_setopt(easy, CURLOPT_HEADERDATA, &transfer);
  curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, take_body);
  curl_easy_setopt(easy, CURLOPT_WRITEDATA, &transfer);
  if (!limits.authorities.empty()) curl_easy_setopt(easy, CURLOPT_CAINFO, limits.authorities.c_str());
  if (request.range) {
    const std::string range = std::to_string(request.range->offset) + "-" + std::to_string(request.range->end() - 1);
    curl_easy_setopt(easy, CURLOPT_RANGE, range.c_str());
  }
  if (request.signing) {
    curl_easy_setopt(easy, CURLOPT_AWS_SIGV4, request.signing->scheme.c_str());
    curl_easy_setopt(easy, CURLOPT_USERNAME, request.signing->key.c_str());
    curl_easy_setopt(easy, CURLOPT_PASSWORD, request.signing->secret.c_str());
  }
  for (const std::string& header : request.headers) {
    transfer.headers.reset(curl_slist_append(transfer.headers.release(), header.c_str()));
  }
  if (transfer.headers) curl_easy_setopt(easy, CURLOPT_HTTPHEADER, transfer.headers.get());
}

/// Sends requests in one thread, several at a time.
class CurlClient {
 public:
  explicit CurlClient(HttpLimits limits) : limits_(std::move(limits)), multi_(curl_multi_init()) {
    thread_ = std::thread([this] { run(); });
  }
  CurlClient(const CurlClient&) = delete;
  CurlClient& operator=(const CurlClient&) = delete;
  ~CurlClient() {
    stopping_ = true;
    curl_multi_wakeup(multi_);
    thread_.join();
    for (const std::unique_ptr<Transfer>& transfer : active_) curl_multi_remove_handle(multi_, transfer->easy.get());
    active_.clear();
    curl_multi_cleanup(multi_);
  }

  void send(HttpRequest request, HttpDone done) {
    auto transfer = std::make_unique<Transfer>(Transfer{std::move(request), std::move(done)});
    {
      const std::lock_guard lock(mutex_);
      sent_.push_back(std::move(transfer));
    }
    curl_multi_wakeup(multi_);
  }

 private:
  using Transfers = std::list<std::unique_ptr<Transfer>>;

  void run() {
    while (!stopping_) {
      begin_due();
      int running = 0;
      curl_multi_perform(multi_, &running);
      finish_answered();
      give_up_overdue();
      if (stopping_) return;
      curl_multi_poll(multi_, nullptr, 0, static_cast<int>(until_next().count()), nullptr);
    }
  }

  /// Begins requests whose time has come, as many as may be on their way.
  void begin_due() {
    {
      const std::lock_guard lock(mutex_);
      waiting_.splice(waiting_.end(), sent_);
    }
    const Clock::time_point now = Clock::now();
    for (auto next = waiting_.begin(); next != waiting_.end() && active_.size() < limits_.requests;) {
      const auto here = next++;
      if ((*here)->request.not_before > now) continue;
      Transfer& transfer = **here;
      transfer.answer.sent = transfer.progress = now;
      transfer.deadline = transfer.request.deadline.value_or(now + transfer.request.time);
      set_options(transfer, limits_);
      active_.splice(active_.end(), waiting_, here);
      curl_multi_add_handle(multi_, transfer.easy.get());
    }
  }

  void finish_answered() {
    int left = 0;
    while (const CURLMsg* message = curl_multi_info_read(multi_, &left)) {
      if (message->msg != CURLMSG_DONE) continue;
      Transfer* transfer = nullptr;
      curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, &transfer);
      const CURLcode code = message->data.result;
      finish(*transfer, code == CURLE_OK ? std::string() : fault_of(*transfer, code));
    }
  }

  /// Empty for answers that were not received further because nobody wants their bodies.
  static std::string fault_of(const Transfer& transfer, CURLcode code) {
    if (transfer.too_long) return "the answer has more bytes than were asked for";
    const bool unwanted = code == CURLE_WRITE_ERROR && transfer.status() != transfer.wanted_status();
    if (unwanted) return {};
    return transfer.reason[0] != '\0' ? transfer.reason.data() : curl_easy_strerror(code);
  }

  void give_up_overdue() {
    const Clock::time_point now = Clock::now();
    for (auto next = active_.begin(); next != active_.end();) {
      Transfer& transfer = **next++;  // finish() takes it out of the list
      if (now >= end_of(transfer)) finish(transfer, "no answer in time");
    }
    Transfers overdue;
    for (auto next = waiting_.begin(); next != waiting_.end();) {
      const auto here = next++;
      if ((*here)->request.deadline && now >= *(*here)->request.deadline) overdue.splice(overdue.end(), waiting_, here);
    }
    for (const std::unique_ptr<Transfer>& transfer : overdue) {
      transfer->answer.sent = now;
      transfer->answer.fault = "not asked in time";
      transfer->done(std::move(transfer->answer));
    }
  }

  /// When a request is given up unless more bytes come.
  [[nodiscard]] Clock::time_point end_of(const Transfer& transfer) const {
    return std::min(std::max(transfer.deadline, live_until(transfer)), transfer.progress + limits_.stall);
  }

  /// As long as what has come of a body is as much as the least rate gives.
  [[nodiscard]] Clock::time_point live_until(const Transfer& transfer) const {
    if (limits_.least_rate == 0) return transfer.answer.sent;
    return transfer.answer.sent + std::chrono::milliseconds(1'000 * transfer.answer.body.size() / limits_.least_rate);
  }

  /// When something has to be done next even if no byte arrives.
  [[nodiscard]] std::chrono::milliseconds until_next() const {
    constexpr std::chrono::milliseconds kMax{1'000};
    Clock::time_point next = Clock::now() + kMax;
    for (const auto& transfer : active_) next = std::min(next, end_of(*transfer));
    for (const auto& transfer : waiting_) {
      if (transfer->request.deadline) next = std::min(next, *transfer->request.deadline);
      if (active_.size() < limits_.requests) next = std::min(next, transfer->request.not_before);
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(next - Clock::now());
    return std::max(left, std::chrono::milliseconds(0));
  }

  void finish(Transfer& transfer, std::string fault) {
    curl_multi_remove_handle(multi_, transfer.easy.get());
    const auto place = std::ranges::find_if(active_, [&](const auto& active) { return active.get() == &transfer; });
    const std::unique_ptr<Transfer> finished = std::move(*place);
    active_.erase(place);
    finished->answer.status = static_cast<int>(finished->status());
    finished->answer.fault = std::move(fault);
    finished->done(std::move(finished->answer));
  }

  const HttpLimits limits_;
  CURLM* const multi_;
  Transfers waiting_;  ///< of the thread, as active_
  Transfers active_;
  std::mutex mutex_;
  Transfers sent_;  ///< guarded by mutex_
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

Result<void*> start_client(const HttpLimits& limits) {
  static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
  if (ready != CURLE_OK) return fail(ErrorKind::kInternal, curl_easy_strerror(ready));
  return new CurlClient(limits);
}

void stop_client(void* client) {
  delete static_cast<CurlClient*>(client);
}

void send_by_client(void* client, HttpRequest request, HttpDone done) {
  static_cast<CurlClient*>(client)->send(std::move(request), std::move(done));
}

}  // namespace
}  // namespace surfcast::object_store

extern "C" const surfcast::object_store::HttpFunctions* surfcast_http_functions() {
  namespace store = surfcast::object_store;
  static constexpr store::HttpFunctions kFunctions{&store::start_client, &store::stop_client, &store::send_by_client};
  return &kFunctions;
}
