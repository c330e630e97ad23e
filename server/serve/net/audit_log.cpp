#include "net/audit_log.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "base/log.h"
#include "base/log_format.h"

namespace surfcast::net {
namespace {

/// Not a setting: a disk that is so far behind does not come back to write the rest.
constexpr size_t kMaxWaiting = 4096;

int open_file(const std::filesystem::path& file) {
  return ::open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
}

tl::unexpected<Error> open_failed(const std::filesystem::path& file) {
  return fail(ErrorKind::kIo, file.string() + ": " + std::strerror(errno));
}

void add_member(std::string& line, std::string_view name, std::string_view value) {
  if (value.empty()) return;
  line.append(",\"").append(name).append("\":\"").append(json_escaped(value)).append("\"");
}

}  // namespace

AuditEvent question_about(const access::AuthorizedModel& model, std::string_view what) {
  return {.what = what, .model = model.name(), .outcome = model.allowed() ? "allowed" : "denied"};
}

std::string audit_line(const AuditEvent& event, const std::string& time) {
  std::string line = "{\"time\":\"" + time + "\"";
  add_member(line, "event", event.what);
  add_member(line, "who", event.who);
  add_member(line, "client", event.client);
  if (event.connection > 0) line += ",\"connection\":" + std::to_string(event.connection);
  add_member(line, "model", event.model);
  add_member(line, "outcome", event.outcome);
  add_member(line, "reason", event.reason);
  if (event.left_out > 0) line += ",\"left_out\":" + std::to_string(event.left_out);
  return line + "}";
}

Result<std::shared_ptr<AuditLog>> AuditLog::open(std::filesystem::path file, size_t denials) {
  const int descriptor = open_file(file);
  if (descriptor < 0) return open_failed(file);
  return std::shared_ptr<AuditLog>(new AuditLog(std::move(file), descriptor, denials));
}

AuditLog::AuditLog(std::filesystem::path file, int descriptor, size_t denials)
    : file_(std::move(file)),
      descriptor_(descriptor),
      denials_(denials),
      writer_(std::make_unique<service::WorkerPool>(1, 0, kMaxWaiting)) {}

AuditLog::~AuditLog() {
  writer_.reset();
  ::close(descriptor_);
}

void AuditLog::write(AuditEvent event) {
  if (event.outcome == "denied") {
    const std::optional<size_t> admitted = denials_.admit(event.client, DenialLimit::Clock::now());
    if (!admitted) {
      ++left_out_;
      return;
    }
    event.left_out = *admitted;
  }
  std::string line = audit_line(event, utc_text(std::chrono::system_clock::now())) + "\n";
  if (!writer_->post([this, line = std::move(line)] { append(line); })) ++lost_;
}

/// Lines that cannot be written are lost, which the log says once for as long as it lasts.
void AuditLog::append(const std::string& line) {
  const std::lock_guard lock(mutex_);
  const bool written = ::write(descriptor_, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  if (!written && !broken_) spdlog::error("{}: the audit log is not written: {}", file_.string(), std::strerror(errno));
  broken_ = !written;
  if (!written) ++lost_;
}

Status AuditLog::reopen() {
  const int descriptor = open_file(file_);
  if (descriptor < 0) return open_failed(file_);
  const std::lock_guard lock(mutex_);
  ::close(std::exchange(descriptor_, descriptor));
  return {};
}

}  // namespace surfcast::net
