#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "base/result.h"
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
};

/// The line of an event, without its end: an object of JSON, of which empty members are left out.
std::string audit_line(const AuditEvent& event, const std::string& time);

/// A file to which every event is added as one line. It is written on a thread of its own: no connection waits for the
/// disk.
class AuditLog {
 public:
  /// Creates the file if there is none, readable for its owner alone.
  static Result<std::shared_ptr<AuditLog>> open(std::filesystem::path file);
  ~AuditLog();
  AuditLog(const AuditLog&) = delete;
  AuditLog& operator=(const AuditLog&) = delete;

  void write(const AuditEvent& event);
  /// Events that could not be written.
  [[nodiscard]] uint64_t lost() const { return lost_; }
  /// Another file may have come under the name: what follows goes there. After an error the former one is written on.
  Status reopen();

 private:
  AuditLog(std::filesystem::path file, int descriptor);
  void append(const std::string& line);

  std::filesystem::path file_;
  std::mutex mutex_;
  int descriptor_;
  bool broken_ = false;
  std::atomic<uint64_t> lost_ = 0;
  std::unique_ptr<service::WorkerPool> writer_;
};

}  // namespace surfcast::net
