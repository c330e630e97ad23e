#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <ctime>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace surfcast::testing {

/// What goes wrong with an answer.
enum class Fault {
  kNone,
  kWholeObject,   ///< 200 with all bytes
  kForbidden,     ///< 403
  kAbsent,        ///< 404
  kReplaced,      ///< 412
  kNoSuchRange,   ///< 416
  kBusy,          ///< 503
  kRedirection,   ///< 302
  kCut,           ///< the connection ends after half of the body
  kHanging,       ///< nothing is answered
  kStalling,      ///< nothing more comes after half of the body
  kDripping,      ///< the body comes over seconds
  kWrongBytes,    ///< a byte of the body is another one
  kWrongRange,    ///< Content-Range states another range
  kShiftedRange,  ///< the range after the one that was asked for, and Content-Range says so
  kOtherVersion,  ///< 206 with the ETag of another version, whatever If-Match says
  kTooLong,       ///< more bytes than were asked for
};

/// A server of objects on 127.0.0.1 that understands ranges and If-Match, counts, and fails as it is told.
class RangeServer {
 public:
  struct Request {
    std::string method;
    std::string target;
    std::map<std::string, std::string> headers;  ///< names in small letters
  };

  RangeServer();
  ~RangeServer();
  RangeServer(const RangeServer&) = delete;
  RangeServer& operator=(const RangeServer&) = delete;

  /// Puts an object under a path like "/bucket/a.surf". It has a new ETag each time.
  void put(const std::string& path, std::string bytes);
  /// Does the same after so many further answers.
  void put_after(size_t answers, const std::string& path, std::string bytes);
  /// Answers requests for this target, with its query, with 200 and these bytes, which were written now.
  void put_page(const std::string& target, std::string bytes);
  /// Does the same with several a minute later, after so many further answers.
  void put_pages_after(size_t answers, std::map<std::string, std::string> pages);
  /// Headers of pages from now on, beside Content-Length and Last-Modified: by default the date.
  void set_page_headers(std::string headers);
  /// ETags that the server states from now on: "" none, "W/" weak ones.
  void set_etag_prefix(std::string prefix);
  /// After `after` further answers, `count` of them have this fault.
  void fail(Fault fault, size_t count, size_t after = 0);
  /// From now on answers wait until release().
  void hold();
  void release();
  /// Waits until so many requests are held, or more.
  void wait_for_held(size_t requests);

  [[nodiscard]] std::string url(const std::string& path) const;
  [[nodiscard]] uint16_t port() const { return port_; }
  [[nodiscard]] std::vector<Request> requests() const;
  /// Bytes of all bodies that were sent.
  [[nodiscard]] uint64_t bytes() const;
  /// Most requests that were answered at a time.
  [[nodiscard]] size_t most_at_once() const;
  void forget_requests();

 private:
  struct Object {
    std::string bytes;
    uint64_t version = 0;
  };
  struct Page {
    std::string bytes;
    time_t written = 0;
  };
  /// What put_after waits with.
  struct LaterObject {
    size_t answers = 0;
    std::string path;
    std::string bytes;
  };
  struct LaterPages {
    size_t answers = 0;
    std::map<std::string, std::string> pages;
  };
  struct Answer {
    std::string head;
    std::string body;
    size_t sent = 0;  ///< of the body
    bool hangs = false;
    bool ends = false;   ///< the connection, after what is sent
    bool drips = false;  ///< in pieces, with pauses between them
  };

  void accept_connections();
  void serve(int connection);
  Answer answer(const Request& request);
  Answer range_answer(const Request& request, const Object& object, Fault fault) const;
  /// Of its body, what a fault lets through.
  static void break_off(Fault fault, Answer& answer);
  [[nodiscard]] Answer page_answer(const Page& page, Fault fault) const;
  [[nodiscard]] std::string etag_of(const Object& object) const;
  Fault next_fault();
  void put_later();

  int listener_ = -1;
  uint16_t port_ = 0;
  std::atomic<bool> stopping_ = false;
  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable changed_;
  bool held_ = false;
  std::map<std::string, Object> objects_;
  std::map<std::string, Page> pages_;
  std::optional<std::string> page_headers_;
  time_t now_ = 1'800'000'000;  ///< of the clock of the server, seconds since 1970
  uint64_t versions_ = 0;
  std::string etag_prefix_ = "\"";
  LaterObject later_;
  LaterPages later_pages_;
  std::deque<Fault> faults_;
  std::vector<Request> requests_;
  uint64_t bytes_ = 0;
  size_t at_once_ = 0;
  size_t most_at_once_ = 0;
  std::set<int> connections_;
  std::vector<std::thread> threads_;
  std::thread acceptor_;
};

}  // namespace surfcast::testing
