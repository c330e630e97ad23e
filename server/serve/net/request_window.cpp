#include "net/request_window.h"

#include <algorithm>
#include <string>

namespace surfcast::net {
namespace {

auto find_request(auto& waiting, RequestWindow::RequestId id) {
  return std::ranges::find_if(waiting, [id](const auto& entry) { return entry.first == id; });
}

}  // namespace

Status RequestWindow::admit(RequestId id) const {
  if (active_.contains(id) || find_request(waiting_, id) != waiting_.end()) {
    return fail(ErrorKind::kInvalidInput, "request " + std::to_string(id) + " is still outstanding");
  }
  if (outstanding() < limits_.outstanding) return {};
  return fail(ErrorKind::kUnavailable,
              "busy: " + std::to_string(limits_.outstanding) + " requests are outstanding on this connection");
}

std::optional<std::pair<RequestWindow::RequestId, service::PictureJob>> RequestWindow::next(size_t outgoing_bytes) {
  if (waiting_.empty() || drawing_ >= limits_.drawing || outgoing_bytes > limits_.outgoing_bytes) return std::nullopt;
  auto entry = std::move(waiting_.front());
  waiting_.pop_front();
  active_.emplace(entry.first, Active{.picture = true, .job = {}});
  ++drawing_;
  return entry;
}

void RequestWindow::set_job(RequestId id, service::JobId job) {
  if (const auto found = active_.find(id); found != active_.end()) found->second.job = job;
}

bool RequestWindow::remove_waiting(RequestId id) {
  const auto found = find_request(waiting_, id);
  if (found == waiting_.end()) return false;
  waiting_.erase(found);
  return true;
}

std::optional<service::JobId> RequestWindow::job(RequestId id) const {
  const auto found = active_.find(id);
  return found == active_.end() ? std::nullopt : found->second.job;
}

void RequestWindow::finish(RequestId id) {
  const auto found = active_.find(id);
  if (found == active_.end()) return;
  if (found->second.picture) --drawing_;
  active_.erase(found);
}

std::vector<service::JobId> RequestWindow::abandon() {
  waiting_.clear();
  std::vector<service::JobId> jobs;
  for (const auto& [id, active] : active_) {
    if (active.job) jobs.push_back(*active.job);
  }
  return jobs;
}

}  // namespace surfcast::net
