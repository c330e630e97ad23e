#include "service/job_queue.h"

#include <algorithm>
#include <utility>

namespace surfcast {

bool JobQueue::push(SessionId session, JobId job) {
  if (size_ >= limit_) return false;
  auto line = std::ranges::find(lines_, session, &Line::session);
  if (line == lines_.end()) line = lines_.insert(lines_.end(), Line{session, {}});
  line->jobs.push_back(job);
  ++size_;
  return true;
}

std::optional<JobId> JobQueue::pop() {
  if (lines_.empty()) return std::nullopt;
  Line line = std::move(lines_.front());
  lines_.pop_front();
  const JobId job = line.jobs.front();
  line.jobs.pop_front();
  --size_;
  if (!line.jobs.empty()) lines_.push_back(std::move(line));
  return job;
}

bool JobQueue::remove(JobId job) {
  for (auto line = lines_.begin(); line != lines_.end(); ++line) {
    const auto found = std::ranges::find(line->jobs, job);
    if (found == line->jobs.end()) continue;
    line->jobs.erase(found);
    --size_;
    if (line->jobs.empty()) lines_.erase(line);
    return true;
  }
  return false;
}

bool JobQueue::contains(JobId job) const {
  return std::ranges::any_of(lines_,
                             [job](const Line& line) { return std::ranges::find(line.jobs, job) != line.jobs.end(); });
}

}  // namespace surfcast
