#include "service/job_queue.h"

#include <algorithm>
#include <utility>

namespace surfcast::service {

size_t JobQueue::waiting_of(ClientId client) const {
  size_t count = 0;
  for (const Lines& lines : lines_) {
    for (const Line& line : lines) count += line.client.id == client ? line.jobs.size() : 0;
  }
  return count;
}

bool JobQueue::push(const Client& client, JobId job, Priority priority) {
  if (size_ >= limit_ || waiting_of(client.id) >= limit_ - limit_ / 8) return false;
  Lines& lines = lines_[static_cast<size_t>(priority)];
  auto line = std::ranges::find_if(lines, [&](const Line& other) { return other.client.session == client.session; });
  if (line == lines.end()) line = lines.insert(lines.end(), Line{client, {}});
  line->jobs.push_back(job);
  shares_.enter(client.id);
  ++size_;
  return true;
}

/// The first of the lines whose client has had least.
JobQueue::Lines::const_iterator JobQueue::next(const Lines& lines, const AcceptsLine& accepts) const {
  auto best = lines.end();
  for (auto line = lines.begin(); line != lines.end(); ++line) {
    if (!accepts(*line)) continue;
    if (best == lines.end() || shares_.used(line->client.id) < shares_.used(best->client.id)) best = line;
  }
  return best;
}

std::optional<JobId> JobQueue::pop(Priority priority, const Accepts& accepts) {
  Lines& lines = lines_[static_cast<size_t>(priority)];
  return take(lines, next(lines, [&](const Line& line) { return !accepts || accepts(line.jobs.front()); }));
}

std::optional<JobId> JobQueue::pop_of_others(Priority priority, const Client& client, const Accepts& accepts) {
  Lines& lines = lines_[static_cast<size_t>(priority)];
  return take(lines, next(lines, [&](const Line& line) {
                return line.client.session != client.session && (!accepts || accepts(line.jobs.front()));
              }));
}

std::optional<ClientId> JobQueue::next_client(Priority priority, const Accepts& accepts) const {
  const Lines& lines = lines_[static_cast<size_t>(priority)];
  const auto line = next(lines, [&](const Line& each) { return !accepts || accepts(each.jobs.front()); });
  return line == lines.end() ? std::nullopt : std::optional(line->client.id);
}

std::optional<JobId> JobQueue::take(Lines& lines, const Lines::const_iterator& place) {
  if (place == lines.end()) return std::nullopt;
  const auto found = lines.begin() + (place - lines.cbegin());
  Line line = std::move(*found);
  lines.erase(found);
  const JobId job = line.jobs.front();
  line.jobs.pop_front();
  --size_;
  if (!line.jobs.empty()) lines.push_back(std::move(line));
  return job;
}

bool JobQueue::remove(JobId job) {
  for (Lines& lines : lines_) {
    for (auto line = lines.begin(); line != lines.end(); ++line) {
      if (std::erase(line->jobs, job) == 0) continue;
      --size_;
      shares_.leave(line->client.id);
      if (line->jobs.empty()) lines.erase(line);
      return true;
    }
  }
  return false;
}

bool JobQueue::contains(JobId job) const {
  return std::ranges::any_of(lines_, [job](const Lines& lines) {
    return std::ranges::any_of(
        lines, [job](const Line& line) { return std::ranges::find(line.jobs, job) != line.jobs.end(); });
  });
}

}  // namespace surfcast::service
