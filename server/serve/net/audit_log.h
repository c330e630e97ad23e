#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "access/authorization.h"
#include "base/result.h"
#include "net/denial_limit.h"
#include "service/worker_pool.h"

namespace surfcast::net {

/// Something that somebody did, or wanted to do.
struct AuditEvent {
  std::string_view what;       ///< "token", "view", "picture", "pick", "profile", "points", "describe", "upload", "end"
  std::string who{};           ///< name of the token; empty: none
  std::string client{};        ///< where from, as in client_name
  uint64_t connection = 0;     ///< its number, as in the log
  std::string model{};         ///< that it is about; empty: none
  std::string_view outcome{};  ///< "allowed" or "denied"
  std::string reason{};        ///< in words; empty: none
  size_t left_out = 0;         ///< denials of the same client before this one that have no line
};

/// That a model was asked about, with what was decided.
AuditEvent question_about(const access::AuthorizedModel& model, std::string_view what);

/// The line of an event, without its end: an object of JSON, of which empty members are left out.
std::string audit_line(const AuditEvent& event, const std::string& time);

/// A file to which events are added, one line each: all that is allowed, and of denials as many as DenialLimit admits.
/// It is written on a thread of its own: no connection waits for the disk.
class AuditLog {
 public:
  /// Creates the file if there is none, readable for its owner alone.
  /// `denials` a minute have lines, of each client; 0: all.
  static Result<std::shared_ptr<AuditLog>> open(std::filesystem::path file, size_t denials);
  ~AuditLog();
  AuditLog(const AuditLog&) = delete;
  AuditLog& operator=(const AuditLog&) = delete;

  /// Called on one thread.
  void write(AuditEvent event);
  /// Events that could not be written.
  [[nodiscard]] uint64_t lost() const { return lost_; }
  /// Denials without a line, beyond their limit.
  [[nodiscard]] uint64_t left_out() const { return left_out_; }
  /// Another file may have come under the name: what follows goes there. After an error the former one is written on.
  Status reopen();

 private:
  AuditLog(std::filesystem::path file, int descriptor, size_t denials);
  void append(const std::string& line);

  std::filesystem::path file_;
  std::mutex mutex_;
  int descriptor_;
  bool broken_ = false;
  std::atomic<uint64_t> lost_ = 0;
  std::atomic<uint64_t> left_out_ = 0;
  DenialLimit denials_;  ///< of the thread that writes events
  std::unique_ptr<service::WorkerPool> writer_;
};

}  // namespace surfcast::net
