#include "object_store/range_server.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <stdexcept>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

namespace surfcast::testing {
namespace {

bool send_all(int connection, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<size_t>(count));
  }
  return true;
}

/// Takes two seconds and a half.
bool send_in_drops(int connection, std::string_view bytes) {
  constexpr size_t kDrops = 10;
  const size_t drop = bytes.size() / kDrops + 1;
  while (!bytes.empty()) {
    if (!send_all(connection, bytes.substr(0, drop))) return false;
    bytes.remove_prefix(std::min(drop, bytes.size()));
    ::usleep(250'000);
  }
  return true;
}

/// The header of the next request, with its empty line; empty at the end of the connection.
std::string read_head(int connection, std::string& unread) {
  for (;;) {
    const size_t end = unread.find("\r\n\r\n");
    if (end != std::string::npos) {
      std::string head = unread.substr(0, end + 4);
      unread.erase(0, end + 4);
      return head;
    }
    char buffer[4096];
    const ssize_t count = ::recv(connection, buffer, sizeof buffer, 0);
    if (count <= 0) return {};
    unread.append(buffer, static_cast<size_t>(count));
  }
}

RangeServer::Request parse(const std::string& head) {
  RangeServer::Request request;
  size_t at = head.find("\r\n");
  const std::string line = head.substr(0, at);
  const size_t target = line.find(' ') + 1;
  request.method = line.substr(0, target - 1);
  request.target = line.substr(target, line.rfind(' ') - target);
  for (at += 2; at + 2 < head.size();) {
    const size_t end = head.find("\r\n", at);
    const size_t colon = head.find(':', at);
    std::string name = head.substr(at, colon - at);
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const size_t value = head.find_first_not_of(' ', colon + 1);
    request.headers[name] = head.substr(value, end - value);
    at = end + 2;
  }
  return request;
}

std::string head_of(const std::string& status, uint64_t length, const std::string& headers = {}) {
  return "HTTP/1.1 " + status + "\r\nContent-Length: " + std::to_string(length) + "\r\n" + headers + "\r\n";
}

/// As in Last-Modified.
std::string http_date(time_t time) {
  std::tm parts{};
  ::gmtime_r(&time, &parts);
  std::array<char, 64> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%a, %d %b %Y %H:%M:%S GMT", &parts)};
}

std::string value_of(const RangeServer::Request& request, const std::string& name) {
  const auto found = request.headers.find(name);
  return found == request.headers.end() ? std::string() : found->second;
}

std::string status_of(Fault fault) {
  switch (fault) {
    case Fault::kForbidden:
      return "403 Forbidden";
    case Fault::kAbsent:
      return "404 Not Found";
    case Fault::kReplaced:
      return "412 Precondition Failed";
    case Fault::kNoSuchRange:
      return "416 Range Not Satisfiable";
    case Fault::kBusy:
      return "503 Service Unavailable";
    case Fault::kRedirection:
      return "302 Found";
    default:
      return {};
  }
}

}  // namespace

RangeServer::RangeServer() : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), length) != 0 || ::listen(listener_, 128) != 0 ||
      ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &length) != 0) {
    throw std::runtime_error("cannot listen");
  }
  port_ = ntohs(address.sin_port);
  acceptor_ = std::thread([this] { accept_connections(); });
}

RangeServer::~RangeServer() {
  stopping_ = true;
  ::shutdown(listener_, SHUT_RDWR);
  acceptor_.join();
  release();
  {
    const std::lock_guard lock(mutex_);
    for (const int connection : connections_) ::shutdown(connection, SHUT_RDWR);
  }
  for (std::thread& thread : threads_) thread.join();
  ::close(listener_);
}

void RangeServer::put(const std::string& path, std::string bytes) {
  const std::lock_guard lock(mutex_);
  objects_[path] = {std::move(bytes), ++versions_};
}

void RangeServer::put_after(size_t answers, const std::string& path, std::string bytes) {
  const std::lock_guard lock(mutex_);
  later_ = {answers, path, std::move(bytes)};
}

/// Called for each request, with mutex_ locked.
void RangeServer::put_later() {
  if (!later_pages_.pages.empty() && later_pages_.answers-- == 0) {
    constexpr time_t kMinute = 60;
    now_ += kMinute;
    for (auto& [target, bytes] : later_pages_.pages) pages_[target] = {std::move(bytes), now_};
    later_pages_ = {};
  }
  if (later_.path.empty() || later_.answers-- > 0) return;
  objects_[later_.path] = {std::move(later_.bytes), ++versions_};
  later_ = {};
}

void RangeServer::put_page(const std::string& target, std::string bytes) {
  const std::lock_guard lock(mutex_);
  pages_[target] = {std::move(bytes), now_};
}

void RangeServer::put_pages_after(size_t answers, std::map<std::string, std::string> pages) {
  const std::lock_guard lock(mutex_);
  later_pages_ = {answers, std::move(pages)};
}

void RangeServer::set_page_headers(std::string headers) {
  const std::lock_guard lock(mutex_);
  page_headers_ = std::move(headers);
}

void RangeServer::set_etag_prefix(std::string prefix) {
  const std::lock_guard lock(mutex_);
  etag_prefix_ = std::move(prefix);
}

void RangeServer::fail(Fault fault, size_t count, size_t after) {
  const std::lock_guard lock(mutex_);
  faults_.assign(after, Fault::kNone);
  faults_.insert(faults_.end(), count, fault);
}

std::string RangeServer::url(const std::string& path) const {
  return "http://127.0.0.1:" + std::to_string(port_) + path;
}

std::vector<RangeServer::Request> RangeServer::requests() const {
  const std::lock_guard lock(mutex_);
  return requests_;
}

uint64_t RangeServer::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

size_t RangeServer::most_at_once() const {
  const std::lock_guard lock(mutex_);
  return most_at_once_;
}

void RangeServer::hold() {
  const std::lock_guard lock(mutex_);
  held_ = true;
}

void RangeServer::release() {
  {
    const std::lock_guard lock(mutex_);
    held_ = false;
  }
  changed_.notify_all();
}

void RangeServer::wait_for_held(size_t requests) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return at_once_ >= requests; });
}

void RangeServer::forget_requests() {
  const std::lock_guard lock(mutex_);
  requests_.clear();
  bytes_ = 0;
  most_at_once_ = 0;
}

void RangeServer::accept_connections() {
  for (;;) {
    const int connection = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (connection < 0 || stopping_) {
      if (connection >= 0) ::close(connection);
      return;
    }
    const int on = 1;
    ::setsockopt(connection, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    const std::lock_guard lock(mutex_);
    connections_.insert(connection);
    threads_.emplace_back([this, connection] { serve(connection); });
  }
}

void RangeServer::serve(int connection) {
  std::string unread;
  for (std::string head; !(head = read_head(connection, unread)).empty();) {
    const Request request = parse(head);
    {
      std::unique_lock lock(mutex_);
      most_at_once_ = std::max(most_at_once_, ++at_once_);
      changed_.notify_all();
      changed_.wait(lock, [this] { return !held_; });
    }
    const Answer answer = this->answer(request);
    {
      // Counted before the client knows of the answer, and sends the next request.
      const std::lock_guard lock(mutex_);
      --at_once_;
      bytes_ += answer.sent;
    }
    bool open = answer.head.empty() || send_all(connection, answer.head);
    const std::string_view body = std::string_view(answer.body).substr(0, answer.sent);
    open = open && (answer.drips ? send_in_drops(connection, body) : send_all(connection, body));
    if (answer.hangs) read_head(connection, unread);  // until the client gives up
    if (!open || answer.ends || answer.hangs) break;
  }
  const std::lock_guard lock(mutex_);
  connections_.erase(connection);
  ::close(connection);
}

void RangeServer::break_off(Fault fault, Answer& answer) {
  const bool half = fault == Fault::kCut || fault == Fault::kStalling;
  answer.sent = half ? answer.body.size() / 2 : answer.body.size();
  answer.ends = fault == Fault::kCut;
  answer.hangs = fault == Fault::kStalling;
  answer.drips = fault == Fault::kDripping;
}

Fault RangeServer::next_fault() {
  if (faults_.empty()) return Fault::kNone;
  const Fault fault = faults_.front();
  faults_.pop_front();
  return fault;
}

std::string RangeServer::etag_of(const Object& object) const {
  if (etag_prefix_.empty()) return {};
  const std::string quote = etag_prefix_.ends_with('"') ? "" : "\"";
  return etag_prefix_ + quote + "version-" + std::to_string(object.version) + "\"";
}

RangeServer::Answer RangeServer::answer(const Request& request) {
  const std::lock_guard lock(mutex_);
  requests_.push_back(request);
  put_later();
  const Fault fault = next_fault();
  if (const std::string status = status_of(fault); !status.empty()) {
    return {head_of(status, 0, "Location: http://127.0.0.1:1/elsewhere\r\n"), {}};
  }
  if (fault == Fault::kHanging) return {{}, {}, 0, true};
  if (const auto page = pages_.find(request.target); page != pages_.end()) {
    return page_answer(page->second, fault);
  }
  const auto object = objects_.find(request.target.substr(0, request.target.find('?')));
  if (object == objects_.end()) return {head_of("404 Not Found", 0), {}};
  const std::string wanted = value_of(request, "if-match");
  if (!wanted.empty() && wanted != etag_of(object->second) && fault != Fault::kOtherVersion) {
    return {head_of("412 Precondition Failed", 0), {}};
  }
  return range_answer(request, object->second, fault);
}

RangeServer::Answer RangeServer::page_answer(const Page& page, Fault fault) const {
  const std::string headers = page_headers_.value_or("Date: " + http_date(now_) + "\r\n");
  Answer answer;
  answer.body = page.bytes;
  answer.head = head_of("200 OK", page.bytes.size(), headers + "Last-Modified: " + http_date(page.written) + "\r\n");
  break_off(fault, answer);
  return answer;
}

RangeServer::Answer RangeServer::range_answer(const Request& request, const Object& object, Fault fault) const {
  const std::string range = value_of(request, "range");
  const std::string etag = etag_of(object);
  const std::string validator = etag.empty() ? "" : "ETag: " + etag + "\r\n";
  const size_t size = object.bytes.size();
  if (range.empty() || fault == Fault::kWholeObject) {
    return {head_of("200 OK", size, validator), object.bytes, size, false, true};
  }
  char* end = nullptr;
  size_t first = std::strtoull(range.c_str() + std::string("bytes=").size(), &end, 10);
  size_t count = std::min<size_t>(std::strtoull(end + 1, nullptr, 10), size - 1) + 1 - first;
  if (fault == Fault::kShiftedRange) first = std::min(first + 1, size - count);
  if (fault == Fault::kTooLong) count = std::min(count + 10, size - first);
  const size_t stated = fault == Fault::kWrongRange ? first + 1 : first;
  const size_t last = (fault == Fault::kWrongRange ? first + 1 : first) + count - 1;
  Answer answer;
  answer.body = object.bytes.substr(first, count);
  if (fault == Fault::kWrongBytes) answer.body[count / 2] = static_cast<char>(answer.body[count / 2] ^ 1);
  answer.head =
      head_of("206 Partial Content", count,
              (fault == Fault::kOtherVersion ? "ETag: \"another\"\r\n" : validator) + "Content-Range: bytes " +
                  std::to_string(stated) + "-" + std::to_string(last) + "/" + std::to_string(size) + "\r\n");
  break_off(fault, answer);
  return answer;
}

}  // namespace surfcast::testing
