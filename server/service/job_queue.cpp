#include "service/job_queue.h"

#include <algorithm>
#include <utility>

namespace surfcast::service {

bool JobQueue::push(SessionId session, JobId job, Priority priority) {
  if (size_ >= limit_) return false;
  Lines& lines = lines_[static_cast<size_t>(priority)];
  auto line = std::ranges::find(lines, session, &Line::session);
  if (line == lines.end()) line = lines.insert(lines.end(), Line{session, {}});
  line->jobs.push_back(job);
  ++size_;
  return true;
}

std::optional<JobId> JobQueue::pop(Priority priority) {
  Lines& lines = lines_[static_cast<size_t>(priority)];
  return take(lines, lines.begin());
}

std::optional<JobId> JobQueue::pop_of_others(Priority priority, SessionId session) {
  Lines& lines = lines_[static_cast<size_t>(priority)];
  return take(lines, std::ranges::find_if(lines, [&](const Line& line) { return line.session != session; }));
}

std::optional<JobId> JobQueue::take(Lines& lines, const Lines::iterator& place) {
  if (place == lines.end()) return std::nullopt;
  Line line = std::move(*place);
  lines.erase(place);
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
